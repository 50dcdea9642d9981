-- is_empty: whether a database has no table, index or view yet.
SELECT NOT EXISTS (SELECT 1 FROM sqlite_schema);
