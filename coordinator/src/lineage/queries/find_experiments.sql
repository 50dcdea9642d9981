-- find_experiments: what a reference names. A number is a number even if an experiment bears it as its name.
WITH meant (id) AS (
    SELECT max(id) FROM experiment WHERE ?1 = 'last'
    UNION
    SELECT id FROM experiment WHERE ?1 <> 'last' AND CAST(id AS TEXT) = ?1
)
SELECT id FROM meant WHERE id IS NOT NULL
UNION
SELECT id FROM experiment
WHERE (name = ?1 OR "group" = ?1) AND NOT EXISTS (SELECT 1 FROM meant WHERE id IS NOT NULL)
ORDER BY id
