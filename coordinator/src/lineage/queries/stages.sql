-- stages: those of an experiment in order, with how many generations each has so far.
SELECT s.id, s.run, s.number, s.name, s.generations, s.ended_ms IS NOT NULL AS ended, s.over,
    (SELECT coalesce(max(g.number), 0) FROM generation AS g WHERE g.stage = s.id) AS latest
FROM stage AS s WHERE s.experiment = ? ORDER BY s.run, s.number
