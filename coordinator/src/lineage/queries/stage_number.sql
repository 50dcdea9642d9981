-- stage_number: which stage of its run.
SELECT number FROM stage WHERE id = ?
