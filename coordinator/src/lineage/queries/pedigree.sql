-- pedigree: all edges above ?1, ?2 generations of them, 0 for all; ?3 follows first parents alone. Without a limit
-- the depth stays 0, so that an ancestor is walked through once however many ways lead to it; with one an edge may
-- come several times.
WITH RECURSIVE up (id, depth) AS (
    SELECT ?1, 0
    UNION
    SELECT p.parent, CASE WHEN ?2 = 0 THEN 0 ELSE up.depth + 1 END
    FROM up JOIN parent AS p ON p.child = up.id
    WHERE (?2 = 0 OR up.depth < ?2) AND (NOT ?3 OR p.ord = 0)
)
SELECT p.child, p.ord, p.parent, p.role
FROM up CROSS JOIN parent AS p ON p.child = up.id
