-- name_traits: the first individual of a stage names the traits of all.
UPDATE stage SET traits = ?2 WHERE id = ?1 AND traits IS NULL
