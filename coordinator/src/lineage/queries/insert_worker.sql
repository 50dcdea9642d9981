-- insert_worker: a worker attached.
INSERT INTO worker (name, host, slots, version, fingerprint, joined_ms)
VALUES (?, ?, ?, ?, ?, CAST(unixepoch('subsec') * 1000 AS INTEGER))
