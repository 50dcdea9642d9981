-- links: the parents of one individual in order.
SELECT p.parent, role.text FROM parent AS p JOIN word AS role ON role.id = p.role
WHERE p.child = ? ORDER BY p.ord
