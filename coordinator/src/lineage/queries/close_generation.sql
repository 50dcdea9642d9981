-- close_generation: its end, with what its outcomes come to. Set-aside individuals count as fitness 0, as they
-- do for the search; the earliest of the best is the best. Steps of inherited outcomes were not simulated.
UPDATE generation
SET ended_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER),
    seconds = ?2, notes = ?3,
    completed = t.completed, culled = t.culled, aborted = t.aborted, failed = t.failed,
    inherited = t.inherited, best = t.best, mean = t.mean, worst = t.worst, steps = t.steps,
    best_individual = (
        SELECT o.individual FROM outcome AS o
        WHERE o.individual BETWEEN generation.first AND generation.first + generation.size - 1
            AND o.fitness IS NOT NULL
        ORDER BY o.fitness DESC, o.individual LIMIT 1)
FROM (
    SELECT
        count(*) FILTER (WHERE w.text = 'completed') AS completed,
        count(*) FILTER (WHERE w.text = 'culled') AS culled,
        count(*) FILTER (WHERE w.text LIKE 'aborted:%') AS aborted,
        count(*) FILTER (WHERE w.text = 'failed') AS failed,
        count(*) FILTER (WHERE i.inherits IS NOT NULL) AS inherited,
        max(coalesce(o.fitness, 0.0)) AS best,
        avg(coalesce(o.fitness, 0.0)) AS mean,
        min(coalesce(o.fitness, 0.0)) AS worst,
        coalesce(sum(o.steps) FILTER (WHERE i.inherits IS NULL), 0) AS steps
    FROM generation AS g
    JOIN outcome AS o ON o.individual BETWEEN g.first AND g.first + g.size - 1
    JOIN individual AS i ON i.id = o.individual
    JOIN word AS w ON w.id = o.status
    WHERE g.id = ?1
) AS t
WHERE generation.id = ?1
