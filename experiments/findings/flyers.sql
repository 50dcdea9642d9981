-- The findings of the flyers' paper, Q-1 to Q-9 (docs/systems/flyers.md), asked of a lineage that holds runs of
-- flyers: `experiments/findings/ask.sh experiments/findings/flyers.sql FILE.db`. Each question is one statement
-- on the documented views. The elite is the best fifth of a run's last generation that lived to its end.

-- Q-1: best fitness never falls and rises strongly.
SELECT g.experiment, e.name, g.run, count(*) AS generations, max(g.individuals) AS population,
       printf('%.0f', max(CASE WHEN g.generation = 1 THEN g.best END)) AS first,
       printf('%.0f', max(g.best)) AS best,
       printf('%.2f', max(g.best) / max(CASE WHEN g.generation = 1 THEN g.best END)) AS times,
       sum(g.best < g.before) AS falls
FROM (SELECT *, lag(best) OVER (PARTITION BY experiment, run ORDER BY generation) AS before
      FROM v_generations WHERE ended_ms IS NOT NULL) AS g
JOIN v_experiments AS e ON e.id = g.experiment
WHERE e.system = 'flyer'
GROUP BY g.experiment, g.run
ORDER BY g.experiment, g.run;

-- Q-2: too much air blows up, too little lets fall; the best is in between. One row a scale of the air.
SELECT e.task ->> 'alpha' AS alpha, count(DISTINCT i.experiment || '/' || i.run) AS runs,
       printf('%.1f', 100.0 * avg(i.status = 'aborted:blow_up')
                            / avg(i.status <> 'aborted:self_intersecting')) AS blown_up_percent,
       printf('%.0f', avg(CASE WHEN i.status = 'completed' THEN i.measures ->> 'hover_steps' END)) AS mean_hover_steps,
       (SELECT printf('%.0f', avg(b.fitness)) FROM v_best AS b JOIN v_experiments AS o ON o.id = b.experiment
        WHERE o.system = 'flyer' AND o.task ->> 'alpha' = e.task ->> 'alpha') AS mean_best
FROM v_individuals AS i
JOIN v_experiments AS e ON e.id = i.experiment
WHERE e.system = 'flyer' AND i.generation = 1
GROUP BY alpha
ORDER BY alpha;

-- Q-3: most land before the end; who hovers for 1000 steps is rare at first and comes later.
SELECT i.experiment, i.run,
       printf('%.1f', 100.0 * avg(CASE WHEN i.status = 'completed' THEN i.measures ->> 'landed' END)) AS landed_percent,
       sum(i.generation = 1 AND i.measures ->> 'hover_steps' > 1000) AS hover_1000_in_first,
       min(CASE WHEN i.measures ->> 'hover_steps' > 1000 THEN i.generation END) AS first_generation_with_1000
FROM v_individuals AS i
JOIN v_experiments AS e ON e.id = i.experiment
WHERE e.system = 'flyer'
GROUP BY i.experiment, i.run
ORDER BY i.experiment, i.run;

-- Q-4 and Q-9: do the best beat their wings, and does any chatter (above 5 Hz)?
WITH last AS (
    SELECT i.*, e.task, percent_rank() OVER (PARTITION BY i.experiment, i.run ORDER BY i.fitness DESC) AS place
    FROM v_individuals AS i
    JOIN v_experiments AS e ON e.id = i.experiment
    JOIN v_stages AS s ON s.experiment = i.experiment AND s.run = i.run AND s.generation = i.generation
    WHERE e.system = 'flyer' AND i.status = 'completed')
SELECT experiment, run, count(*) AS elite,
       printf('%.2f', avg(measures ->> 'flap_frequency')) AS mean_beat_hz,
       printf('%.2f', max(measures ->> 'flap_frequency')) AS fastest_hz,
       sum(measures ->> 'flap_frequency' < 0.05) AS hardly_beat,
       sum(measures ->> 'flap_frequency' > 5.0) AS chatter
FROM last WHERE place <= 0.2
GROUP BY experiment, run
ORDER BY experiment, run;

-- Q-5: long wings beat slowly: Spearman's rank correlation of span and beat over all elites, each body once.
WITH last AS (
    SELECT i.measures ->> 'span' AS span, i.measures ->> 'flap_frequency' AS beat,
           percent_rank() OVER (PARTITION BY i.experiment, i.run ORDER BY i.fitness DESC) AS place
    FROM v_individuals AS i
    JOIN v_experiments AS e ON e.id = i.experiment
    JOIN v_stages AS s ON s.experiment = i.experiment AND s.run = i.run AND s.generation = i.generation
    WHERE e.system = 'flyer' AND i.status = 'completed'),
elite AS (SELECT DISTINCT span, beat FROM last WHERE place <= 0.2),
-- Equals share the mean of their ranks.
ranked AS (
    SELECT rank() OVER (ORDER BY span) + (count(*) OVER (PARTITION BY span) - 1) / 2.0 AS x,
           rank() OVER (ORDER BY beat) + (count(*) OVER (PARTITION BY beat) - 1) / 2.0 AS y
    FROM elite)
SELECT count(*) AS bodies,
       printf('%.3f', 1.0 - 6.0 * sum((x - y) * (x - y)) / (count(*) * (count(*) * count(*) - 1.0))) AS rank_correlation
FROM ranked;

-- Q-6: the lightest elites against the others: do they glide without a beat?
WITH last AS (
    SELECT i.measures ->> 'mass' AS mass, i.measures ->> 'flap_frequency' AS beat, i.measures ->> 'distance' AS distance,
           percent_rank() OVER (PARTITION BY i.experiment, i.run ORDER BY i.fitness DESC) AS place
    FROM v_individuals AS i
    JOIN v_experiments AS e ON e.id = i.experiment
    JOIN v_stages AS s ON s.experiment = i.experiment AND s.run = i.run AND s.generation = i.generation
    WHERE e.system = 'flyer' AND i.status = 'completed'),
weighed AS (SELECT *, ntile(4) OVER (ORDER BY mass) AS quarter FROM last WHERE place <= 0.2)
SELECT quarter AS weight_quarter, count(*) AS flyers, printf('%.2f', avg(mass)) AS mean_kg,
       printf('%.2f', avg(beat)) AS mean_beat_hz, sum(beat < 0.05) AS hardly_beat,
       printf('%.0f', avg(distance)) AS mean_distance
FROM weighed GROUP BY quarter ORDER BY quarter;

-- Q-7: straight ahead or in turns: the way from start to end by the way flown, 1 for a straight line. The way
-- flown is of the smoothed speed (F-57), which cuts corners: a little above 1 is straight as well.
WITH last AS (
    SELECT i.*, e.task ->> 'dt' AS dt,
           percent_rank() OVER (PARTITION BY i.experiment, i.run ORDER BY i.fitness DESC) AS place
    FROM v_individuals AS i
    JOIN v_experiments AS e ON e.id = i.experiment
    JOIN v_stages AS s ON s.experiment = i.experiment AND s.run = i.run AND s.generation = i.generation
    WHERE e.system = 'flyer' AND i.status = 'completed'),
flown AS (
    SELECT experiment, run, (measures ->> 'distance') / (dt * (measures ->> 'speed_sum')) AS straightness
    FROM last WHERE place <= 0.2 AND measures ->> 'speed_sum' > 0)
SELECT experiment, run, count(*) AS elite, printf('%.2f', avg(straightness)) AS mean_straightness,
       sum(straightness > 0.8) AS straight, sum(straightness < 0.4) AS turning
FROM flown GROUP BY experiment, run ORDER BY experiment, run;

-- Q-8: what culling saves and costs: means over runs with and without it, by scale of the air, size and length.
SELECT e.task ->> 'alpha' AS alpha, g.population, g.generations,
       CASE WHEN g.cull_at IS NULL THEN 'off' ELSE 'on' END AS culling, count(*) AS runs,
       printf('%.0f', avg(g.steps)) AS mean_steps, printf('%.0f', avg(g.best)) AS mean_best,
       printf('%.0f', min(g.best)) AS least, printf('%.0f', max(g.best)) AS most
FROM (SELECT experiment, run, max(cull_at) AS cull_at, sum(steps) AS steps, max(best) AS best,
             max(individuals) AS population, count(*) AS generations
      FROM v_generations WHERE ended_ms IS NOT NULL GROUP BY experiment, run) AS g
JOIN v_experiments AS e ON e.id = g.experiment
WHERE e.system = 'flyer'
GROUP BY alpha, g.population, g.generations, culling
ORDER BY alpha, g.population, g.generations, culling;
