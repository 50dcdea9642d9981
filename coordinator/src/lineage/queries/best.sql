-- best: of the latest stage of every experiment in the JSON list ?1, inherited outcomes left out. The ids of
-- generations bound the scan of outcomes.
SELECT o.individual
FROM stage AS s
JOIN generation AS g ON g.stage = s.id
CROSS JOIN outcome AS o ON o.individual BETWEEN g.first AND g.first + g.size - 1
JOIN individual AS i ON i.id = o.individual
WHERE s.experiment IN (SELECT value FROM json_each(?1))
    AND s.number = (SELECT max(l.number) FROM stage AS l WHERE l.experiment = s.experiment)
    AND o.fitness IS NOT NULL AND i.inherits IS NULL
ORDER BY o.fitness DESC, o.individual
LIMIT ?2
