-- experiment: one, with all that is needed to take it up again.
SELECT id, name, "group", cell, system, system_version, search, seed, runs, task, resolved, digest, published,
    fingerprint, state, reason, created_ms, ended_ms, planned, origin, origin_stage
FROM experiment WHERE id = ?
