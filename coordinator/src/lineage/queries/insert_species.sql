-- insert_species: what a search says of its species at a generation's end (walker G-45).
INSERT INTO species (generation, id, size, best, share, quota, representative, stagnant)
VALUES (?, ?, ?, ?, ?, ?, ?, ?)
