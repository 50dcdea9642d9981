-- insert_parent: in the order in which the search names them.
INSERT INTO parent (child, ord, parent, role) VALUES (?, ?, ?, ?)
