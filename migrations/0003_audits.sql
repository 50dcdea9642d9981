-- Audits, workers that are trusted no more, and events for people to read.

ALTER TABLE outcome ADD COLUMN audit INTEGER REFERENCES word (id); -- agreed or skipped; NULL: not chosen for one

ALTER TABLE worker ADD COLUMN quarantined_ms INTEGER;              -- since when its name is trusted no more

-- Every attempt at an evaluation: those that counted, and the others.
DROP VIEW v_evaluations;
CREATE VIEW v_evaluations AS
SELECT
    o.individual,
    o.attempt,
    s.experiment,
    w.name AS worker,
    'counted' AS fate,
    status.text AS status,
    o.fitness,
    o.steps,
    o.micros / 1e6 AS seconds,
    o.interim_step,
    o.interim_measure,
    CASE WHEN o.verdict IS NOT NULL THEN g.cutoff END AS cutoff,
    verdict.text AS verdict,
    audit.text AS audit
FROM outcome AS o
JOIN individual AS i ON i.id = o.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
JOIN word AS status ON status.id = o.status
LEFT JOIN word AS verdict ON verdict.id = o.verdict
LEFT JOIN word AS audit ON audit.id = o.audit
LEFT JOIN worker AS w ON w.id = o.worker
WHERE o.attempt IS NOT NULL
UNION ALL
SELECT a.individual, a.number, s.experiment, w.name, a.fate, NULL, NULL, a.steps, a.micros / 1e6,
    NULL, NULL, NULL, NULL, NULL
FROM attempt AS a
JOIN individual AS i ON i.id = a.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
LEFT JOIN worker AS w ON w.id = a.worker;

-- Audits by generation, of those that had some.
CREATE VIEW v_audits AS
SELECT
    s.experiment,
    s.run,
    s.number AS stage,
    g.number AS generation,
    count(*) AS chosen,
    count(*) FILTER (WHERE audit.text = 'agreed') AS agreed,
    count(*) FILTER (WHERE audit.text = 'skipped') AS skipped
FROM outcome AS o
JOIN word AS audit ON audit.id = o.audit
JOIN individual AS i ON i.id = o.individual
JOIN generation AS g ON g.id = i.generation
JOIN stage AS s ON s.id = g.stage
GROUP BY g.id;

-- Every attachment of a worker.
DROP VIEW v_workers;
CREATE VIEW v_workers AS
SELECT id, name, host, slots, version, lower(hex(fingerprint)) AS fingerprint, joined_ms, left_ms, reason,
    quarantined_ms
FROM worker;

-- What happened besides.
CREATE VIEW v_events AS
SELECT id, experiment, at_ms, kind, text, data
FROM event;
