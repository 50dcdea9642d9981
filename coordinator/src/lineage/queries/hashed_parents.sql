-- hashed_parents: the parents of a range of individuals, in order.
SELECT p.child, p.parent, role.text
FROM parent AS p JOIN word AS role ON role.id = p.role
WHERE p.child BETWEEN ?1 AND ?2
ORDER BY p.child, p.ord
