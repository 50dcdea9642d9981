-- insert_genotype: as packed.
INSERT INTO genotype (individual, digest, base, size, bytes) VALUES (?, ?, ?, ?, ?)
