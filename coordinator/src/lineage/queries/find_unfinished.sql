-- find_unfinished: the latest unfinished experiment of a resolved file.
SELECT id FROM experiment WHERE state IN ('running', 'paused', 'awaiting') AND digest = ? ORDER BY id DESC LIMIT 1
