-- ancestors: the individuals of a JSON list, with words and generations by their ids: there are few of those.
SELECT i.id, i.generation, i.operator, o.status, o.fitness_bits
FROM json_each(?1) AS a
CROSS JOIN individual AS i ON i.id = a.value
LEFT JOIN outcome AS o ON o.individual = i.id
