-- checkpoint: the state of the search before it asked for a generation of a stage.
SELECT size, digest, state FROM checkpoint WHERE stage = ?1 AND generation = ?2
