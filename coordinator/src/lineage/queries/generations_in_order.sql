-- generations_in_order: those of an experiment, by run and place.
SELECT s.run, s.number AS stage, g.number AS generation, g.first, g.size
FROM stage AS s JOIN generation AS g ON g.stage = s.id
WHERE s.experiment = ?
ORDER BY s.run, s.number, g.number
