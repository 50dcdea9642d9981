-- retract_outcomes: individuals of an open generation are pending again; ?1 is a JSON list of them.
DELETE FROM outcome WHERE individual IN (SELECT value FROM json_each(?1))
