-- end_stage: its last generation has ended.
UPDATE stage SET ended_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER) WHERE id = ?
