-- inherit_outcome: an individual of equal genotype takes over the outcome, and nothing of the attempt. Both are of
-- one stage, whose names the measures have.
INSERT INTO outcome (individual, status, fitness, fitness_bits, steps, interim_step, interim_measure, verdict, note,
    m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, m10, m11, measures)
SELECT ?1, o.status, o.fitness, o.fitness_bits, o.steps, o.interim_step, o.interim_measure, o.verdict, o.note,
    o.m0, o.m1, o.m2, o.m3, o.m4, o.m5, o.m6, o.m7, o.m8, o.m9, o.m10, o.m11, o.measures
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual JOIN generation AS giver ON giver.id = i.generation
JOIN individual AS j ON j.id = ?1 JOIN generation AS heir ON heir.id = j.generation
WHERE o.individual = ?2 AND heir.stage = giver.stage
ON CONFLICT (individual) DO NOTHING
