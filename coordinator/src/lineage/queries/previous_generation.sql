-- previous_generation: the ids of the one before.
SELECT first, size FROM generation WHERE stage = ?1 AND number = ?2 - 1
