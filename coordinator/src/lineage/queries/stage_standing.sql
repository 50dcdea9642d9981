-- stage_standing: where a stage belongs, and how far it is.
SELECT s.experiment, s.run, s.number, s.ended_ms IS NOT NULL AS ended,
    (SELECT max(g.number) FROM generation AS g WHERE g.stage = s.id) AS latest,
    (SELECT g.id FROM generation AS g WHERE g.stage = s.id AND g.ended_ms IS NULL) AS open
FROM stage AS s WHERE s.id = ?
