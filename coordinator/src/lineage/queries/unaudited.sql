-- unaudited: outcomes of generations that have ended in an experiment which rest on the word of the workers named ?2
-- alone. They stand: what was bred from them stands as well.
SELECT count(*)
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
WHERE s.experiment = ?1 AND g.ended_ms IS NOT NULL
    AND o.worker IN (SELECT id FROM worker WHERE name = ?2)
    AND (o.audit IS NULL OR o.audit NOT IN (SELECT id FROM word WHERE text = 'agreed'))
