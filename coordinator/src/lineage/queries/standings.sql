-- standings: a range of individuals, their genotypes' digests and what became of them.
SELECT i.id, t.digest, w.text AS status, o.fitness_bits, o.steps, o.interim_step, o.interim_measure, o.note,
    s.measures AS measure_names, o.m0, o.m1, o.m2, o.m3, o.m4, o.m5, o.m6, o.m7, o.m8, o.m9, o.m10, o.m11, o.measures
FROM individual AS i
JOIN genotype AS t ON t.individual = i.id
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
LEFT JOIN outcome AS o ON o.individual = i.id
LEFT JOIN word AS w ON w.id = o.status
WHERE i.id BETWEEN ?1 AND ?2
ORDER BY i.id
