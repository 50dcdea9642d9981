-- name_measures: the first outcome that measures something names them for the stage.
UPDATE stage SET measures = ?2 WHERE id = ?1 AND measures IS NULL
