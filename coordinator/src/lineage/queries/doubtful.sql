-- doubtful: individuals within ?1 to ?2 whose ending rests on the word of the workers named ?3 alone, with those who
-- inherit from them there, and the number of the last attempt at each. An ending that an audit has confirmed rests on
-- two words; one that was set aside is in doubt if one of its attempts was theirs.
WITH RECURSIVE
suspect (id) AS MATERIALIZED (SELECT id FROM worker WHERE name = ?3),
agreed (id) AS MATERIALIZED (SELECT id FROM word WHERE text = 'agreed'),
doubtful (id) AS (
    SELECT o.individual
    FROM outcome AS o
    JOIN individual AS i ON i.id = o.individual
    WHERE o.individual BETWEEN ?1 AND ?2
        AND i.inherits IS NULL
        AND (o.audit IS NULL OR o.audit NOT IN (SELECT id FROM agreed))
        AND (o.worker IN (SELECT id FROM suspect)
            OR o.attempt IS NULL AND EXISTS (
                SELECT 1 FROM attempt AS a
                WHERE a.individual = o.individual AND a.worker IN (SELECT id FROM suspect)))
    UNION
    SELECT i.id
    FROM doubtful AS d
    JOIN individual AS i ON i.inherits = d.id
    WHERE i.id BETWEEN ?1 AND ?2
)
SELECT d.id, max(
    coalesce((SELECT max(a.number) FROM attempt AS a WHERE a.individual = d.id), 0),
    coalesce(o.attempt, 0)) AS attempts
FROM doubtful AS d
JOIN outcome AS o ON o.individual = d.id
ORDER BY d.id
