-- words: those that the writer already knows.
SELECT text, id FROM word
