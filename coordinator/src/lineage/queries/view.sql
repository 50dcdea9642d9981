-- view: one of the documented views, whole. `{view}` is one of their names.
SELECT * FROM {view}
