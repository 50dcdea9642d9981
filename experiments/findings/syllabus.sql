-- The results of the ESP paper that a lineage answers by itself (docs/systems/esp.md), asked of one that holds syllabus
-- experiments: `experiments/findings/ask.sh experiments/findings/syllabus.sql FILE.db`. Each question is one statement
-- on the documented views.

-- R-1, R-3: what each skill came to, and what it cost. Best is that of whoever goes on, under the skill's own fitness.
SELECT g.experiment, g.run, g.stage_name AS skill, count(*) AS generations, sum(g.notes ->> 'trials') AS trials,
       sum(g.notes ->> 'tests_new') AS new, sum(g.notes ->> 'tests_retest') AS again,
       sum(g.notes ->> 'tests_reconcile') AS reconciling,
       printf('%.1f', sum(g.steps) / 1e6) AS million_steps, printf('%.0f', sum(g.seconds)) AS seconds,
       printf('%.3f', max(g.best)) AS best
FROM v_generations AS g
JOIN v_experiments AS e ON e.id = g.experiment
WHERE e.system = 'esp' AND g.ended_ms IS NOT NULL AND g.stage_name NOT LIKE '%: measure'
GROUP BY g.experiment, g.run, g.stage
ORDER BY g.experiment, g.run, g.stage;

-- R-2: the generation in which a population has nine tenths of what it reaches, by skill, over its populations.
WITH p AS (
    SELECT g.experiment, g.run, g.stage, g.stage_name, g.generation, b.key AS population, b.value AS best,
           max(b.value) OVER (PARTITION BY g.experiment, g.run, g.stage, b.key) AS final
    FROM v_generations AS g, json_each(g.notes) AS b
    WHERE b.key LIKE 'best.%' AND g.ended_ms IS NOT NULL AND g.stage_name NOT LIKE '%:%'
),
t AS (
    SELECT experiment, run, stage, stage_name, population, final, min(generation) AS generations
    FROM p WHERE best >= 0.9 * final GROUP BY experiment, run, stage, population
)
SELECT experiment, run, stage_name AS skill, count(*) AS populations, group_concat(generations, ' ') AS generations,
       max(generations) - min(generations) AS spread, group_concat(printf('%.3f', final), ' ') AS best
FROM t GROUP BY experiment, run, stage HAVING populations > 1 ORDER BY experiment, run, stage;

-- R-7, R-8, R-12: bodies, the best candidate of each population of a skill.
SELECT experiment, run, stage_name AS skill, population, individual, printf('%.3f', fitness) AS fitness,
       notes ->> 'parts' AS parts, printf('%.1f', notes ->> 'mass') AS mass_kg, notes ->> 'muscles' AS muscles,
       substr(notes ->> 'skeleton', 1, 8) AS skeleton, picked
FROM (SELECT *, row_number() OVER (PARTITION BY experiment, run, stage, population ORDER BY rank) AS place
      FROM v_candidates)
WHERE place = 1
ORDER BY experiment, run, stage, population;

-- R-6: what General mode costs older skills and wins back: the skill that is evolved, stage by stage.
SELECT g.experiment, g.run, g.stage, g.stage_name, printf('%.3f', max(CASE WHEN g.generation = 1 THEN g.best END)) AS first,
       printf('%.3f', max(g.best)) AS best
FROM v_generations AS g
JOIN v_experiments AS e ON e.id = g.experiment
WHERE e.system = 'esp' AND g.ended_ms IS NOT NULL
GROUP BY g.experiment, g.run, g.stage
HAVING g.stage_name LIKE '%: %'
ORDER BY g.experiment, g.run, g.stage;
