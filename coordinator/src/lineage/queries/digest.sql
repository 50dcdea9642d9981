-- digest: of one genotype.
SELECT digest FROM genotype WHERE individual = ?
