-- insert_experiment: as it was submitted, running from now on.
INSERT INTO experiment (name, "group", cell, system, system_version, search, seed, runs, task, resolved, digest,
    published, planned, program_version, fingerprint, origin, origin_stage, state, created_ms)
VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, 'running', CAST(unixepoch('subsec') * 1000 AS INTEGER))
