-- end_stage: its last generation has ended, and perhaps its run.
UPDATE stage SET ended_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER), over = ?2 WHERE id = ?1
