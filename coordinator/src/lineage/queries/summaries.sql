-- summaries: experiments with their counts; ?1 is a JSON list of their numbers, or NULL for all.
SELECT id, name, "group", cell, system, search, state, reason, seed, runs, created_ms, ended_ms, individuals,
    planned, evaluated, culled, aborted, failed
FROM v_experiments
WHERE ?1 IS NULL OR id IN (SELECT value FROM json_each(?1))
ORDER BY id
