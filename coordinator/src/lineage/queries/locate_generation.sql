-- locate_generation: the ids of a generation, named by its place in a run; of a fork, through its origin.
WITH RECURSIVE holder (experiment, least, most) AS (
    -- An experiment holds its own stages beyond its fork, and its origin those up to there.
    SELECT id, coalesce(origin_stage + 1, 0), 4294967295 FROM experiment WHERE id = ?1
    UNION ALL
    SELECT o.id, coalesce(o.origin_stage + 1, 0), min(h.most, e.origin_stage)
    FROM holder AS h JOIN experiment AS e ON e.id = h.experiment JOIN experiment AS o ON o.id = e.origin
)
SELECT g.first, g.size
FROM holder AS h
JOIN stage AS s ON s.experiment = h.experiment AND s.number BETWEEN h.least AND h.most
JOIN generation AS g ON g.stage = s.id
WHERE s.run = ?2 AND s.number = ?3 AND g.number = ?4
