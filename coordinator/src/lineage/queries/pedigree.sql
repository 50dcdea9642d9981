-- pedigree: all edges above ?1, those of one child in order: ?2 generations of them, 0 for all; ?3 follows
-- first parents alone. Without a limit the depth stays 0, so that an ancestor is walked through once however
-- many ways lead to it.
WITH RECURSIVE up (id, depth) AS (
    SELECT ?1, 0
    UNION
    SELECT p.parent, CASE WHEN ?2 = 0 THEN 0 ELSE up.depth + 1 END
    FROM up JOIN parent AS p ON p.child = up.id
    WHERE (?2 = 0 OR up.depth < ?2) AND (NOT ?3 OR p.ord = 0)
)
SELECT p.child, p.parent, role.text
FROM (SELECT DISTINCT id FROM up) AS u
JOIN parent AS p ON p.child = u.id
JOIN word AS role ON role.id = p.role
ORDER BY p.child, p.ord
