-- unfinished: what a restart takes up again.
SELECT id FROM experiment WHERE state IN ('running', 'paused') ORDER BY id
