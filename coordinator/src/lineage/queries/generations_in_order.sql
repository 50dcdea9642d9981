-- generations_in_order: those of an experiment, by run and place, of a fork with those of its origin. Those of
-- runs that the fork has not are left out.
WITH RECURSIVE holder (experiment, least, most) AS (
    -- An experiment holds its own stages beyond its fork, and its origin those up to there.
    SELECT id, coalesce(origin_stage + 1, 0), 4294967295 FROM experiment WHERE id = ?1
    UNION ALL
    SELECT o.id, coalesce(o.origin_stage + 1, 0), min(h.most, e.origin_stage)
    FROM holder AS h JOIN experiment AS e ON e.id = h.experiment JOIN experiment AS o ON o.id = e.origin
)
SELECT s.run, s.number AS stage, g.number AS generation, g.first, g.size
FROM holder AS h
JOIN stage AS s ON s.experiment = h.experiment AND s.number BETWEEN h.least AND h.most
JOIN generation AS g ON g.stage = s.id
WHERE s.run <= (SELECT runs FROM experiment WHERE id = ?1)
ORDER BY s.run, s.number, g.number
