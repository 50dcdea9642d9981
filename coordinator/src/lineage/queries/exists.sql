-- exists: whether there is such an individual.
SELECT EXISTS (SELECT 1 FROM individual WHERE id = ?)
