-- giver: whose evaluation an outcome comes from, through all who inherited it.
WITH RECURSIVE back (id, inherits) AS (
    SELECT id, inherits FROM individual WHERE id = ?
    UNION
    SELECT i.id, i.inherits FROM back JOIN individual AS i ON i.id = back.inherits
)
SELECT id FROM back WHERE inherits IS NULL
