-- The views are the lineage's public interface: docs/lineage.md names every column. They read in any SQLite
-- since 3.38, as the shells and notebooks of people have it.

-- Individuals with their place, their outcome and the attempt that counted.
CREATE VIEW v_individuals AS
SELECT
    i.id,
    s.experiment,
    s.run,
    s.number AS stage,
    g.number AS generation,
    i.id - g.first AS idx,
    operator.text AS operator,
    coalesce(status.text, 'pending') AS status,
    o.fitness,
    o.fitness_bits,
    -- Names stand once in the stage; an individual with others carries its own.
    CASE json_type(i.traits) WHEN 'object' THEN i.traits ELSE
        (SELECT json_group_object(n.value, i.traits -> n.key) FROM json_each(s.traits) AS n)
    END AS traits,
    CASE
        WHEN o.m0 IS NOT NULL THEN (
            SELECT json_group_object(n.value, CASE n.key
                WHEN 0 THEN o.m0 WHEN 1 THEN o.m1 WHEN 2 THEN o.m2 WHEN 3 THEN o.m3
                WHEN 4 THEN o.m4 WHEN 5 THEN o.m5 WHEN 6 THEN o.m6 WHEN 7 THEN o.m7
                WHEN 8 THEN o.m8 WHEN 9 THEN o.m9 WHEN 10 THEN o.m10 WHEN 11 THEN o.m11
            END) FROM json_each(s.measures) AS n)
        WHEN o.measures IS NOT NULL THEN
            (SELECT json_group_object(n.value ->> 0, n.value -> 1) FROM json_each(o.measures) AS n)
        WHEN o.fitness_bits IS NOT NULL THEN '{}'
    END AS measures,
    o.steps,
    o.interim_step,
    o.interim_measure,
    verdict.text AS verdict,
    coalesce(o.note, '') AS note,
    i.inherits,
    w.name AS worker,
    o.micros / 1e6 AS seconds
FROM individual AS i
-- The range of ids says what the key says already, and lets SQLite begin from a generation as well.
JOIN generation AS g ON g.id = i.generation AND i.id BETWEEN g.first AND g.first + g.size - 1
JOIN stage AS s ON s.id = g.stage
JOIN word AS operator ON operator.id = i.operator
LEFT JOIN outcome AS o ON o.individual = i.id
LEFT JOIN word AS status ON status.id = o.status
LEFT JOIN word AS verdict ON verdict.id = o.verdict
LEFT JOIN worker AS w ON w.id = o.worker;

-- Generations. While one is open its counts are taken from what is on file so far.
CREATE VIEW v_generations AS
SELECT
    g.id,
    s.experiment,
    s.run,
    s.number AS stage,
    s.name AS stage_name,
    g.number AS generation,
    g.size AS individuals,
    CASE WHEN g.ended_ms IS NOT NULL THEN g.completed + g.culled + g.aborted + g.failed ELSE
        (SELECT count(*) FROM outcome AS o WHERE o.individual BETWEEN g.first AND g.first + g.size - 1)
    END AS evaluated,
    CASE WHEN g.ended_ms IS NOT NULL THEN g.completed ELSE
        (SELECT count(*) FROM outcome AS o JOIN word AS w ON w.id = o.status
         WHERE o.individual BETWEEN g.first AND g.first + g.size - 1 AND w.text = 'completed')
    END AS completed,
    CASE WHEN g.ended_ms IS NOT NULL THEN g.culled ELSE
        (SELECT count(*) FROM outcome AS o JOIN word AS w ON w.id = o.status
         WHERE o.individual BETWEEN g.first AND g.first + g.size - 1 AND w.text = 'culled')
    END AS culled,
    CASE WHEN g.ended_ms IS NOT NULL THEN g.aborted ELSE
        (SELECT count(*) FROM outcome AS o JOIN word AS w ON w.id = o.status
         WHERE o.individual BETWEEN g.first AND g.first + g.size - 1 AND w.text LIKE 'aborted:%')
    END AS aborted,
    CASE WHEN g.ended_ms IS NOT NULL THEN g.failed ELSE
        (SELECT count(*) FROM outcome AS o JOIN word AS w ON w.id = o.status
         WHERE o.individual BETWEEN g.first AND g.first + g.size - 1 AND w.text = 'failed')
    END AS failed,
    g.inherited,
    g.best,
    g.mean,
    g.worst,
    g.best_individual,
    g.steps,
    g.seconds,
    g.cull_at,
    g.cutoff,
    g.notes,
    g.begun_ms,
    g.ended_ms
FROM generation AS g
JOIN stage AS s ON s.id = g.stage;

-- The best of every stage of every run so far: the earliest of equals.
CREATE VIEW v_best AS
WITH leader (stage, individual, fitness) AS (
    SELECT stage, best_individual, best FROM generation
    WHERE ended_ms IS NOT NULL AND best_individual IS NOT NULL
    UNION ALL
    SELECT g.stage, o.individual, o.fitness
    FROM generation AS g
    JOIN outcome AS o ON o.individual BETWEEN g.first AND g.first + g.size - 1
    WHERE g.ended_ms IS NULL AND o.fitness IS NOT NULL
),
ranked AS (
    SELECT s.experiment, s.run, s.number AS stage, l.individual, l.fitness,
        row_number() OVER (PARTITION BY l.stage ORDER BY l.fitness DESC, l.individual) AS rank
    FROM leader AS l JOIN stage AS s ON s.id = l.stage
)
SELECT r.experiment, e.name AS experiment_name, r.run, r.stage, i.generation, i.idx, r.individual, r.fitness,
    i.traits
FROM ranked AS r
JOIN experiment AS e ON e.id = r.experiment
JOIN v_individuals AS i ON i.id = r.individual
WHERE r.rank = 1;

-- Stages, with how far they are.
CREATE VIEW v_stages AS
SELECT
    s.id,
    s.experiment,
    e.name AS experiment_name,
    s.run,
    s.number AS stage,
    s.name,
    s.seed,
    s.generations,
    (SELECT max(g.number) FROM generation AS g WHERE g.stage = s.id) AS generation,
    (SELECT coalesce(sum(g.size), 0) FROM generation AS g WHERE g.stage = s.id) AS individuals,
    b.fitness AS best,
    b.individual AS best_individual,
    s.begun_ms,
    s.ended_ms,
    coalesce(s.task, e.task) AS task
FROM stage AS s
JOIN experiment AS e ON e.id = s.experiment
LEFT JOIN v_best AS b ON b.experiment = s.experiment AND b.run = s.run AND b.stage = s.number;

-- Experiments, with what became of their individuals.
CREATE VIEW v_experiments AS
SELECT
    e.id,
    e.id AS experiment,
    e.name,
    e."group",
    e.cell,
    e.system,
    e.system_version,
    e.search,
    e.seed,
    e.runs,
    e.state,
    e.reason,
    coalesce(c.individuals, 0) AS individuals,
    e.planned,
    coalesce(c.evaluated, 0) AS evaluated,
    coalesce(c.completed, 0) AS completed,
    coalesce(c.culled, 0) AS culled,
    coalesce(c.aborted, 0) AS aborted,
    coalesce(c.failed, 0) AS failed,
    e.task,
    e.published,
    e.resolved,
    e.program_version,
    lower(hex(e.digest)) AS digest,
    lower(hex(e.fingerprint)) AS fingerprint,
    e.created_ms,
    e.ended_ms,
    e.origin,
    e.origin_stage
FROM experiment AS e
LEFT JOIN (
    SELECT experiment, sum(individuals) AS individuals, sum(evaluated) AS evaluated,
        sum(completed) AS completed, sum(culled) AS culled, sum(aborted) AS aborted, sum(failed) AS failed
    FROM v_generations GROUP BY experiment
) AS c ON c.experiment = e.id;

-- Who came from whom.
CREATE VIEW v_parents AS
SELECT p.child, p.parent, role.text AS role, p.ord, s.experiment
FROM parent AS p
JOIN word AS role ON role.id = p.role
JOIN individual AS i ON i.id = p.child
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage;

-- Every attempt at an evaluation: those that counted, and the others.
CREATE VIEW v_evaluations AS
SELECT
    o.individual,
    o.attempt,
    s.experiment,
    w.name AS worker,
    'counted' AS fate,
    status.text AS status,
    o.fitness,
    o.steps,
    o.micros / 1e6 AS seconds,
    o.interim_step,
    o.interim_measure,
    CASE WHEN o.verdict IS NOT NULL THEN g.cutoff END AS cutoff,
    verdict.text AS verdict
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
JOIN word AS status ON status.id = o.status
LEFT JOIN word AS verdict ON verdict.id = o.verdict
LEFT JOIN worker AS w ON w.id = o.worker
WHERE o.attempt IS NOT NULL
UNION ALL
SELECT a.individual, a.number, s.experiment, w.name, a.fate, NULL, NULL, a.steps, a.micros / 1e6,
    NULL, NULL, NULL, NULL
FROM attempt AS a
JOIN individual AS i ON i.id = a.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
LEFT JOIN worker AS w ON w.id = a.worker;

-- Interim reports below the cutoff: culled, or spared for the control sample, whose fitness shows what
-- culling would have cost.
CREATE VIEW v_culls AS
SELECT
    o.individual,
    s.experiment,
    s.run,
    s.number AS stage,
    g.number AS generation,
    o.individual - g.first AS idx,
    printf('interim measure below the cutoff at %g of the steps', g.cull_at) AS rule,
    o.interim_step AS step,
    o.interim_measure AS measure,
    g.cutoff,
    verdict.text AS verdict,
    status.text AS status,
    o.fitness
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual
JOIN generation AS g ON g.id = i.generation AND i.id BETWEEN g.first AND g.first + g.size - 1
JOIN stage AS s ON s.id = g.stage
JOIN word AS verdict ON verdict.id = o.verdict
JOIN word AS status ON status.id = o.status
WHERE verdict.text IN ('cull', 'spare') AND i.inherits IS NULL;

-- The whole pedigree of an individual. Name the individual: `WHERE individual = 4711` walks its pedigree
-- alone, since the walk stands in a subquery of its row; without it every pedigree there is gets walked.
CREATE VIEW v_ancestors AS
SELECT
    i.id AS individual,
    a.value ->> 0 AS ancestor,
    a.value ->> 1 AS depth,
    s.experiment,
    s.run,
    s.number AS stage,
    g.number AS generation,
    (a.value ->> 0) - g.first AS idx,
    operator.text AS operator,
    coalesce(status.text, 'pending') AS status,
    o.fitness
FROM individual AS i
JOIN json_each((
    WITH RECURSIVE up (id, depth) AS (
        SELECT p.parent, 1 FROM parent AS p WHERE p.child = i.id
        UNION
        SELECT p.parent, up.depth + 1 FROM up JOIN parent AS p ON p.child = up.id
    ),
    nearest (id, depth) AS (SELECT id, min(depth) FROM up GROUP BY id)
    SELECT json_group_array(json_array(id, depth)) FROM nearest
)) AS a
JOIN individual AS ancestor ON ancestor.id = a.value ->> 0
JOIN generation AS g ON g.id = ancestor.generation
JOIN stage AS s ON s.id = g.stage
JOIN word AS operator ON operator.id = ancestor.operator
LEFT JOIN outcome AS o ON o.individual = ancestor.id
LEFT JOIN word AS status ON status.id = o.status;

-- Species by generation (walker G-45).
CREATE VIEW v_species AS
SELECT s.experiment, s.run, s.number AS stage, g.number AS generation, p.id AS species, p.size, p.best,
    p.share, p.quota, p.representative, p.stagnant
FROM species AS p
JOIN generation AS g ON g.id = p.generation
JOIN stage AS s ON s.id = g.stage;

-- Workers, a row for every time one attached.
CREATE VIEW v_workers AS
SELECT id, name, host, slots, version, lower(hex(fingerprint)) AS fingerprint, joined_ms, left_ms, reason
FROM worker;

-- Where stages go on.
CREATE VIEW v_checkpoints AS
SELECT s.experiment, s.run, s.number AS stage, c.generation, c.size, length(c.state) AS stored, c.saved_ms
FROM checkpoint AS c
JOIN stage AS s ON s.id = c.stage;

-- Who may go on, or might have, from the end of a stage.
CREATE VIEW v_candidates AS
SELECT
    c.experiment,
    s.run,
    s.number AS stage,
    s.name AS stage_name,
    c.rank,
    c.individual,
    i.generation,
    i.idx,
    i.traits ->> 'population' AS population,
    c.fitness,
    c.notes,
    p.individual IS NOT NULL AS picked
FROM candidate AS c
JOIN stage AS s ON s.id = c.stage
JOIN v_individuals AS i ON i.id = c.individual
LEFT JOIN pick AS p ON p.experiment = c.experiment AND p.stage = c.stage AND p.individual = c.individual;

-- Who did.
CREATE VIEW v_picks AS
SELECT
    p.experiment,
    s.run,
    s.number AS stage,
    s.name AS stage_name,
    p.individual,
    c.rank,
    c.fitness,
    p.picked_by,
    p.note,
    p.picked_ms
FROM pick AS p
JOIN stage AS s ON s.id = p.stage
JOIN candidate AS c ON c.experiment = p.experiment AND c.stage = p.stage AND c.individual = p.individual;
