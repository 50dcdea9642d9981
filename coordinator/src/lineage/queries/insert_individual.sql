-- insert_individual: written once, never changed.
INSERT INTO individual (id, generation, operator, traits, inherits) VALUES (?, ?, ?, ?, ?)
