-- attempts: every attempt at one individual.
SELECT attempt AS number, coalesce(worker, '') AS worker, fate, steps, coalesce(seconds, 0.0) AS seconds
FROM v_evaluations WHERE individual = ? ORDER BY attempt
