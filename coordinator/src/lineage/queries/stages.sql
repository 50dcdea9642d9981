-- stages: those of an experiment in order.
SELECT id, run, number, name, generations, ended_ms IS NOT NULL AS ended
FROM stage WHERE experiment = ? ORDER BY run, number
