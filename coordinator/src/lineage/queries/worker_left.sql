-- worker_left: the first word about its going away stands.
UPDATE worker SET left_ms = CAST(unixepoch('subsec') * 1000 AS INTEGER), reason = ?2
WHERE id = ?1 AND left_ms IS NULL
