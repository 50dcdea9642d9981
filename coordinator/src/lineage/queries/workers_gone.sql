-- workers_gone: a writer that opens the file finds workers of its predecessor, which said no goodbye.
UPDATE worker SET left_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER), reason = 'the coordinator ended'
WHERE left_ms IS NULL
