-- ancestors: the individuals of a JSON list.
SELECT i.id, s.number AS stage, g.number AS generation, i.id - g.first AS idx, operator.text AS operator,
    coalesce(status.text, 'pending') AS status, o.fitness_bits
FROM json_each(?1) AS a
CROSS JOIN individual AS i ON i.id = a.value
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
JOIN word AS operator ON operator.id = i.operator
LEFT JOIN outcome AS o ON o.individual = i.id
LEFT JOIN word AS status ON status.id = o.status
