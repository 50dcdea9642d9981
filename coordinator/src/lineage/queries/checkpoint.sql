-- checkpoint: the latest of a stage.
SELECT size, state FROM checkpoint WHERE stage = ?
