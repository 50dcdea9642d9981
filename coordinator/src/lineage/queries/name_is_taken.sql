-- name_is_taken: experiments and matrices share one space of names, so that a reference means one thing.
SELECT EXISTS (SELECT 1 FROM experiment WHERE name = ?1 OR "group" = ?1)
