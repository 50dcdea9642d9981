-- insert_event: something that people should know.
INSERT INTO event (experiment, at_ms, kind, text, data)
VALUES (?, CAST(unixepoch('subsec') * 1000 AS INTEGER), ?, ?, ?)
