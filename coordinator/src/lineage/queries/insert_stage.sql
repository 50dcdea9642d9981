-- insert_stage: one search of one run begins.
INSERT INTO stage (experiment, run, number, name, seed, generations, task, begun_ms)
VALUES (?, ?, ?, ?, ?, ?, ?, CAST(unixepoch('subsec') * 1000 AS INTEGER))
