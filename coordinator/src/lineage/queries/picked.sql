-- picked: where in its run the one stands who was picked at the end of a stage.
SELECT s.number, g.number, p.individual - g.first
FROM pick AS p
JOIN individual AS i ON i.id = p.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
WHERE p.experiment = ?1 AND p.stage = ?2
