-- save_checkpoint: of a stage's generation.
INSERT INTO checkpoint (stage, generation, size, digest, state, saved_ms)
VALUES (?, ?, ?, ?, ?, CAST(unixepoch('subsec') * 1000 AS INTEGER))
