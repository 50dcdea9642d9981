-- insert_generation: a search asked for these individuals at once.
INSERT INTO generation (stage, number, first, size, cull_at, cutoff, begun_ms)
VALUES (?, ?, ?, ?, ?, ?, CAST(unixepoch('subsec') * 1000 AS INTEGER))
