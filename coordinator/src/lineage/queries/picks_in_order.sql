-- picks_in_order: who went on from which stage, as far as an experiment and its origins chose. At the end of the
-- stage where it forks, a fork chooses itself.
WITH RECURSIVE holder (experiment, least, most) AS (
    -- An experiment holds its own stages beyond its fork, and its origin those up to there.
    SELECT id, coalesce(origin_stage + 1, 0), 4294967295 FROM experiment WHERE id = ?1
    UNION ALL
    SELECT o.id, coalesce(o.origin_stage + 1, 0), min(h.most, e.origin_stage)
    FROM holder AS h JOIN experiment AS e ON e.id = h.experiment JOIN experiment AS o ON o.id = e.origin
)
SELECT s.run, s.number AS stage, p.individual
FROM holder AS h
JOIN pick AS p ON p.experiment = h.experiment
JOIN stage AS s ON s.id = p.stage AND s.number BETWEEN h.least - 1 AND h.most
WHERE s.run <= (SELECT runs FROM experiment WHERE id = ?1)
    AND (h.experiment = ?1 OR s.number < h.most)
ORDER BY s.run, s.number
