-- set_state: what an experiment is up to.
UPDATE experiment
SET state = ?2, reason = ?3,
    ended_ms = CASE
        WHEN ?2 IN ('running', 'paused', 'awaiting') THEN NULL
        ELSE coalesce(ended_ms, CAST(unixepoch('subsec') * 1000 AS INTEGER))
    END
WHERE id = ?1
