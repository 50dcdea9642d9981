-- candidates: of every choice of an experiment, with who was picked.
SELECT s.id AS stage, s.run, s.number, s.name, c.rank, c.individual,
    CAST(i.traits ->> 'population' AS INTEGER) AS population, c.fitness, c.notes,
    p.individual AS picked, p.picked_by, p.note
FROM candidate AS c
JOIN stage AS s ON s.id = c.stage
JOIN v_individuals AS i ON i.id = c.individual
LEFT JOIN pick AS p ON p.experiment = c.experiment AND p.stage = c.stage
WHERE c.experiment = ?
ORDER BY s.run, s.number, c.rank
