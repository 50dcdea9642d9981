-- unfinished: what has not ended.
SELECT id FROM experiment WHERE state IN ('running', 'paused', 'awaiting') ORDER BY id
