-- identity: what tells this lineage from every other.
SELECT identity FROM lineage
