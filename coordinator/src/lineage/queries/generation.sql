-- generation: the ids of one of a stage.
SELECT first, size FROM generation WHERE stage = ?1 AND number = ?2
