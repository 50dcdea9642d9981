-- insert_pick: who goes on: one of the candidates, and the first word stands.
INSERT INTO pick (experiment, stage, individual, picked_by, note, picked_ms)
SELECT c.experiment, c.stage, c.individual, ?4, ?5, CAST(unixepoch('subsec') * 1000 AS INTEGER)
FROM candidate AS c
WHERE c.experiment = ?1 AND c.stage = ?2 AND c.individual = ?3
