-- hashed_individuals: the canonical columns of a range of individuals.
SELECT i.id, operator.text AS operator, coalesce(status.text, 'pending') AS status, o.fitness_bits,
    t.digest, t.base, t.size, t.bytes
FROM individual AS i
JOIN genotype AS t ON t.individual = i.id
JOIN word AS operator ON operator.id = i.operator
LEFT JOIN outcome AS o ON o.individual = i.id
LEFT JOIN word AS status ON status.id = o.status
WHERE i.id BETWEEN ?1 AND ?2
ORDER BY i.id
