-- retract_attempts: what counted, counts no more; ?1 is a JSON list of individuals.
INSERT INTO attempt (individual, number, worker, fate, steps, micros)
SELECT o.individual, o.attempt, o.worker, 'retracted', o.steps, coalesce(o.micros, 0)
FROM outcome AS o
WHERE o.individual IN (SELECT value FROM json_each(?1)) AND o.attempt IS NOT NULL AND o.worker IS NOT NULL
