-- view_of_experiments: the rows of one of the documented views that belong to experiments of a JSON list.
SELECT * FROM {view} WHERE experiment IN (SELECT value FROM json_each(?1))
