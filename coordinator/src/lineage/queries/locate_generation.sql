-- locate_generation: the ids of a generation, named by its place in a run.
SELECT g.first, g.size
FROM stage AS s JOIN generation AS g ON g.stage = s.id
WHERE s.experiment = ?1 AND s.run = ?2 AND s.number = ?3 AND g.number = ?4
