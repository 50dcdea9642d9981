-- individual: one, with its genotype's digest and what its evaluation needs.
SELECT v.id, v.experiment, e.name AS experiment_name, v.run, v.stage, s.name AS stage_name, v.generation, v.idx,
    v.operator, v.status AS standing, v.traits, v.verdict, v.inherits, s.seed AS run_seed, g.cull_at, g.cutoff,
    e.system, e.system_version, coalesce(s.task, e.task) AS task, t.digest,
    (SELECT count(*) FROM parent AS p WHERE p.parent = v.id) AS children,
    w.text AS status, o.fitness_bits, o.steps, o.interim_step, o.interim_measure, o.note,
    s.measures AS measure_names, o.m0, o.m1, o.m2, o.m3, o.m4, o.m5, o.m6, o.m7, o.m8, o.m9, o.m10, o.m11, o.measures
FROM v_individuals AS v
JOIN experiment AS e ON e.id = v.experiment
JOIN individual AS i ON i.id = v.id
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
JOIN genotype AS t ON t.individual = v.id
LEFT JOIN outcome AS o ON o.individual = v.id
LEFT JOIN word AS w ON w.id = o.status
WHERE v.id = ?
