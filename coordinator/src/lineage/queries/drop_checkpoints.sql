-- drop_checkpoints: all of a stage before the two latest.
DELETE FROM checkpoint WHERE stage = ?1 AND generation < ?2 - 1
