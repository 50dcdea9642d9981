-- worker_quarantined: a name is trusted no more, from the first word of it on.
UPDATE worker SET quarantined_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER)
WHERE name = ? AND quarantined_ms IS NULL
