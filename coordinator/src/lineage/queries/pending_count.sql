-- pending_count: individuals of a generation that have no outcome yet.
SELECT g.size - (SELECT count(*) FROM outcome AS o WHERE o.individual BETWEEN g.first AND g.first + g.size - 1)
FROM generation AS g WHERE g.id = ?
