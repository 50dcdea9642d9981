-- last_individual: ids are given in memory from here on.
SELECT coalesce(max(id), 0) FROM individual
