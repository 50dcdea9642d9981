-- save_checkpoint: the latest of a stage replaces the one before.
INSERT INTO checkpoint (stage, generation, size, state, saved_ms)
VALUES (?, ?, ?, ?, CAST(unixepoch('subsec') * 1000 AS INTEGER))
ON CONFLICT (stage) DO UPDATE SET
    generation = excluded.generation, size = excluded.size, state = excluded.state, saved_ms = excluded.saved_ms
