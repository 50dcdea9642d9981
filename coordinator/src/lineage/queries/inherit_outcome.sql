-- inherit_outcome: an individual of equal genotype takes over the outcome, and nothing of the attempt.
INSERT INTO outcome (individual, status, fitness, fitness_bits, steps, measures, interim_step, interim_measure,
    verdict, note)
SELECT ?1, o.status, o.fitness, o.fitness_bits, o.steps,
    -- Numbers without names mean the names of their own stage.
    CASE WHEN heir.stage = giver.stage OR json_type(o.measures, '$[0]') = 'array' THEN o.measures ELSE
        (SELECT json_group_array(json_array(n.value, o.measures -> n.key))
         FROM stage AS s, json_each(s.measures) AS n WHERE s.id = giver.stage)
    END,
    o.interim_step, o.interim_measure, o.verdict, o.note
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual JOIN generation AS giver ON giver.id = i.generation
JOIN individual AS j ON j.id = ?1 JOIN generation AS heir ON heir.id = j.generation
WHERE o.individual = ?2
ON CONFLICT (individual) DO NOTHING
