-- standings: a range of individuals, their genotypes' digests and what became of them.
SELECT i.id, t.digest, w.text AS status, o.fitness_bits, o.steps, o.measures, s.measures AS measure_names,
    o.interim_step, o.interim_measure, o.note
FROM individual AS i
JOIN genotype AS t ON t.individual = i.id
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
LEFT JOIN outcome AS o ON o.individual = i.id
LEFT JOIN word AS w ON w.id = o.status
WHERE i.id BETWEEN ?1 AND ?2
ORDER BY i.id
