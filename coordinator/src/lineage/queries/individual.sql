-- individual: one, with what its evaluation needs.
SELECT v.id, v.experiment, e.name AS experiment_name, v.run, v.stage, s.name AS stage_name, v.generation, v.idx,
    v.operator, v.status, v.fitness_bits, v.traits, v.measures, v.steps, v.interim_step, v.interim_measure,
    v.verdict, v.note, v.inherits, s.seed AS run_seed, g.cull_at, g.cutoff, e.system, e.system_version, e.task,
    t.digest, (SELECT count(*) FROM parent AS p WHERE p.parent = v.id) AS children
FROM v_individuals AS v
JOIN experiment AS e ON e.id = v.experiment
JOIN stage AS s ON s.experiment = v.experiment AND s.run = v.run AND s.number = v.stage
JOIN generation AS g ON g.stage = s.id AND g.number = v.generation
JOIN genotype AS t ON t.individual = v.id
WHERE v.id = ?
