-- worker_names: the latest attachment of every name.
SELECT name, max(id) FROM worker GROUP BY name
