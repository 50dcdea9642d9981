-- insert_attempt: one that did not count.
INSERT INTO attempt (individual, number, worker, fate, steps, micros) VALUES (?, ?, ?, ?, ?, ?)
ON CONFLICT (individual, number) DO NOTHING
