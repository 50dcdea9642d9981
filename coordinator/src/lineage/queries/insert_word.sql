-- insert_word: one that recurs in rows, written when it is first used.
INSERT INTO word (text) VALUES (?)
