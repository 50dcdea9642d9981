-- has_outcome: whether an individual is settled.
SELECT EXISTS (SELECT 1 FROM outcome WHERE individual = ?)
