-- progress: the latest stage of every run, with its latest generation.
SELECT s.experiment, s.run, s.number AS stage, s.name AS stage_name, coalesce(v.generation, 0) AS generation,
    s.generations, coalesce(v.evaluated, 0) AS done, coalesce(v.individuals, 0) AS size,
    b.fitness AS best, b.individual AS best_individual, s.ended_ms IS NOT NULL AS ended
FROM stage AS s
LEFT JOIN v_generations AS v
    ON v.id = (SELECT g.id FROM generation AS g WHERE g.stage = s.id ORDER BY g.number DESC LIMIT 1)
LEFT JOIN v_best AS b ON b.experiment = s.experiment AND b.run = s.run AND b.stage = s.number
WHERE (?1 IS NULL OR s.experiment IN (SELECT value FROM json_each(?1)))
    AND s.number = (SELECT max(o.number) FROM stage AS o WHERE o.experiment = s.experiment AND o.run = s.run)
ORDER BY s.experiment, s.run
