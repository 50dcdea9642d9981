-- amend_experiment: it goes on with a changed file.
UPDATE experiment SET resolved = ?2, digest = ?3, task = ?4, planned = ?5 WHERE id = ?1
