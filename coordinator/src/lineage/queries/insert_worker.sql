-- insert_worker: a worker attached. A name that is trusted no more stays so.
INSERT INTO worker (name, host, slots, version, fingerprint, joined_ms, quarantined_ms)
VALUES (?1, ?2, ?3, ?4, ?5, CAST(unixepoch('subsec') * 1000 AS INTEGER),
    (SELECT max(quarantined_ms) FROM worker WHERE name = ?1))
