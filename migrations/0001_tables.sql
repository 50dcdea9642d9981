-- The lineage: every individual, its parents, its outcome, and where it came from. People read the views of
-- the next file; these tables may change between releases, those do not.
--
-- A released migration never changes: write the next one.

-- The file itself.
CREATE TABLE lineage (
    id         INTEGER PRIMARY KEY CHECK (id = 1),
    identity   BLOB    NOT NULL CHECK (length(identity) = 16), -- tells workers whose evaluations they hold
    created_ms INTEGER NOT NULL                                -- Unix time, as every _ms here
) STRICT;

-- Words that recur in every row (statuses, operators, roles, verdicts), each stored once.
CREATE TABLE word (
    id   INTEGER PRIMARY KEY,
    text TEXT    NOT NULL UNIQUE
) STRICT;

CREATE TABLE experiment (
    id              INTEGER PRIMARY KEY,
    name            TEXT    NOT NULL UNIQUE CHECK (name <> ''),
    "group"         TEXT,                                        -- the matrix that it is a cell of
    cell            TEXT    NOT NULL CHECK (json_type(cell) = 'object'),
    system          TEXT    NOT NULL,
    system_version  INTEGER NOT NULL,
    search          TEXT    NOT NULL,                            -- its kind
    seed            INTEGER NOT NULL,                            -- of run 1; 64 bits, those over 2^63 negative
    runs            INTEGER NOT NULL CHECK (runs >= 1),
    task            TEXT    NOT NULL CHECK (json_valid(task)),   -- resolved
    resolved        TEXT    NOT NULL,                            -- the whole file with every default
    digest          BLOB    NOT NULL CHECK (length(digest) = 32), -- BLAKE3 of `resolved`
    published       TEXT    NOT NULL CHECK (json_valid(published)),
    planned         INTEGER,                                     -- individuals in all, when known
    program_version TEXT    NOT NULL,
    fingerprint     BLOB    NOT NULL CHECK (length(fingerprint) = 32), -- of the physics
    state           TEXT    NOT NULL
        CHECK (state IN ('running', 'paused', 'awaiting', 'finished', 'cancelled', 'failed')),
    reason          TEXT    NOT NULL DEFAULT '',
    created_ms      INTEGER NOT NULL,
    ended_ms        INTEGER,
    -- A fork: its runs went through the stages of `origin` up to the one numbered `origin_stage`, and through
    -- their own after it.
    origin          INTEGER REFERENCES experiment (id),
    origin_stage    INTEGER,
    CHECK ((origin IS NULL) = (origin_stage IS NULL))
) STRICT;

CREATE INDEX experiment_group ON experiment ("group") WHERE "group" IS NOT NULL;

-- One search of one run.
CREATE TABLE stage (
    id          INTEGER PRIMARY KEY,
    experiment  INTEGER NOT NULL REFERENCES experiment (id),
    run         INTEGER NOT NULL CHECK (run >= 1),
    number      INTEGER NOT NULL CHECK (number >= 0),
    name        TEXT    NOT NULL,
    seed        INTEGER NOT NULL,                                -- of the run
    generations INTEGER,                                         -- how many it takes, when known
    task        TEXT CHECK (task IS NULL OR json_valid(task)),   -- resolved; NULL: the experiment's
    traits      TEXT CHECK (json_type(traits) = 'array'),        -- their names, in the order of individual.traits
    measures    TEXT CHECK (json_type(measures) = 'array'),      -- their names, in the order of outcome.m0, m1, …
    begun_ms    INTEGER NOT NULL,
    ended_ms    INTEGER,
    over        INTEGER NOT NULL DEFAULT 0 CHECK (over IN (0, 1)), -- 1: the run has ended with it
    UNIQUE (experiment, run, number)
) STRICT;

-- What a search asked for at once. Its individuals are numbered `first` to `first + size - 1` in order of
-- index, so that a range of ids is a generation, and no index on generations is needed.
CREATE TABLE generation (
    id              INTEGER PRIMARY KEY,
    stage           INTEGER NOT NULL REFERENCES stage (id),
    number          INTEGER NOT NULL CHECK (number >= 1),
    first           INTEGER NOT NULL,
    size            INTEGER NOT NULL CHECK (size >= 1),
    cull_at         REAL,                                        -- share of the task's steps; NULL: no culling
    cutoff          REAL,                                        -- measures below it are culled
    begun_ms        INTEGER NOT NULL,
    ended_ms        INTEGER,
    -- Known once it has ended, from its outcomes:
    completed       INTEGER,
    culled          INTEGER,
    aborted         INTEGER,
    failed          INTEGER,
    inherited       INTEGER,                                     -- counted above as well, by their status
    best            REAL,
    mean            REAL,
    worst           REAL,
    best_individual INTEGER,
    steps           INTEGER,                                     -- simulated for outcomes that were not inherited
    seconds         REAL,                                        -- on the wall
    notes           TEXT CHECK (json_type(notes) = 'object'),    -- what the search says of it
    UNIQUE (stage, number)
) STRICT;

CREATE INDEX generation_open ON generation (stage) WHERE ended_ms IS NULL;

-- Written once, never changed.
CREATE TABLE individual (
    id         INTEGER PRIMARY KEY,
    generation INTEGER NOT NULL REFERENCES generation (id),
    operator   INTEGER NOT NULL REFERENCES word (id),
    traits     TEXT    NOT NULL,                                 -- JSON: an array of values for the names in stage.traits,
                                                                 -- or an object with names of its own
    inherits   INTEGER REFERENCES individual (id)                -- whose outcome it takes over
) STRICT;

-- `ord` counts an individual's parents from 0; the first of them is the line of descent.
CREATE TABLE parent (
    child  INTEGER NOT NULL REFERENCES individual (id),
    ord    INTEGER NOT NULL,
    parent INTEGER NOT NULL REFERENCES individual (id),
    role   INTEGER NOT NULL REFERENCES word (id),
    PRIMARY KEY (child, ord)
) STRICT, WITHOUT ROWID;

CREATE INDEX parent_children ON parent (parent);

-- In a table of their own, so that a scan of individuals does not read them. `bytes` is, by its length:
-- `size`: the genotype itself; shorter: one zstd frame, with the genotype of `base` as raw content dictionary
-- if there is a base. A chain of bases has at most 16 links.
CREATE TABLE genotype (
    individual INTEGER PRIMARY KEY REFERENCES individual (id),
    digest     BLOB    NOT NULL CHECK (length(digest) = 16),     -- the first half of its BLAKE3
    base       INTEGER REFERENCES genotype (individual),
    size       INTEGER NOT NULL,
    bytes      BLOB    NOT NULL CHECK (length(bytes) <= size)
) STRICT;

-- How an individual ended, and the attempt that counted. Written once. An individual without a row is pending.
CREATE TABLE outcome (
    individual      INTEGER PRIMARY KEY REFERENCES individual (id),
    status          INTEGER NOT NULL REFERENCES word (id),       -- completed, culled, failed, aborted:REASON
    fitness         REAL,                                        -- NULL where it is not a number, and for failed
    fitness_bits    INTEGER,                                     -- its IEEE 754 bits; NULL for failed
    steps           INTEGER NOT NULL,
    interim_step    INTEGER,
    interim_measure REAL,
    verdict         INTEGER REFERENCES word (id),                -- on the interim report: pass, cull, spare
    note            TEXT,
    attempt         INTEGER,                                     -- NULL: inherited, or failed
    worker          INTEGER REFERENCES worker (id),
    micros          INTEGER,                                     -- spent by the worker, for statistics alone
    -- What was measured: in columns, since as text it would weigh more than all the rest. Nothing stands in m0
    -- if nothing was measured, or if it does not fit: too many, NaN or −0, other names than the stage's.
    m0 REAL, m1 REAL, m2 REAL, m3 REAL, m4 REAL, m5 REAL, m6 REAL, m7 REAL, m8 REAL, m9 REAL, m10 REAL, m11 REAL,
    measures        TEXT CHECK (json_type(measures) = 'array')   -- what does not fit: pairs of name and value
) STRICT;

-- Attempts that did not count: lost, failed, or too late.
CREATE TABLE attempt (
    individual INTEGER NOT NULL REFERENCES individual (id),
    number     INTEGER NOT NULL,
    worker     INTEGER NOT NULL REFERENCES worker (id),
    fate       TEXT    NOT NULL,
    steps      INTEGER NOT NULL,
    micros     INTEGER NOT NULL,
    PRIMARY KEY (individual, number)
) STRICT, WITHOUT ROWID;

-- All that a stage needs to go on: the search's state before it asked for `generation`, which of a stage that
-- has ended is the one that did not come. One zstd frame. The latest two of a stage are kept, so that one that
-- is damaged can be made again from the one before.
CREATE TABLE checkpoint (
    stage      INTEGER NOT NULL REFERENCES stage (id),
    generation INTEGER NOT NULL,
    size       INTEGER NOT NULL,
    digest     BLOB    NOT NULL CHECK (length(digest) = 32),     -- BLAKE3 of the state itself
    state      BLOB    NOT NULL,
    saved_ms   INTEGER NOT NULL,
    PRIMARY KEY (stage, generation)
) STRICT;

-- Species of a generation, for searches that have them (walker G-45).
CREATE TABLE species (
    generation     INTEGER NOT NULL REFERENCES generation (id),
    id             INTEGER NOT NULL,                             -- in the run, never reused
    size           INTEGER NOT NULL,
    best           REAL,
    share          REAL,
    quota          INTEGER NOT NULL,
    representative INTEGER REFERENCES individual (id),
    stagnant       INTEGER NOT NULL,
    PRIMARY KEY (generation, id)
) STRICT, WITHOUT ROWID;

-- Who may go on from the end of a stage, best first, and who did. The experiment is the stage's, or a fork of
-- it that chooses anew.
CREATE TABLE candidate (
    experiment INTEGER NOT NULL REFERENCES experiment (id),
    stage      INTEGER NOT NULL REFERENCES stage (id),
    rank       INTEGER NOT NULL CHECK (rank >= 1),
    individual INTEGER NOT NULL REFERENCES individual (id),
    fitness    REAL    NOT NULL,
    notes      TEXT    NOT NULL CHECK (json_type(notes) = 'object'), -- what the search says of it
    PRIMARY KEY (experiment, stage, rank)
) STRICT, WITHOUT ROWID;

CREATE TABLE pick (
    experiment INTEGER NOT NULL REFERENCES experiment (id),
    stage      INTEGER NOT NULL REFERENCES stage (id),
    individual INTEGER NOT NULL REFERENCES individual (id),
    picked_by  TEXT    NOT NULL CHECK (picked_by IN ('best', 'human')),
    note       TEXT    NOT NULL DEFAULT '',
    picked_ms  INTEGER NOT NULL,
    PRIMARY KEY (experiment, stage)
) STRICT, WITHOUT ROWID;

-- Workers, a row for every time one attached.
CREATE TABLE worker (
    id          INTEGER PRIMARY KEY,
    name        TEXT    NOT NULL,
    host        TEXT    NOT NULL,
    slots       INTEGER NOT NULL,
    version     TEXT    NOT NULL,
    fingerprint BLOB    NOT NULL,
    joined_ms   INTEGER NOT NULL,
    left_ms     INTEGER,
    reason      TEXT                                             -- why it left
) STRICT;

CREATE INDEX worker_name ON worker (name);

-- What happened besides, for people.
CREATE TABLE event (
    id         INTEGER PRIMARY KEY,
    experiment INTEGER REFERENCES experiment (id),               -- NULL: of the service
    at_ms      INTEGER NOT NULL,
    kind       TEXT    NOT NULL,
    text       TEXT    NOT NULL,
    data       TEXT    NOT NULL CHECK (json_type(data) = 'object')
) STRICT;

CREATE INDEX event_experiment ON event (experiment);

INSERT INTO lineage (id, identity, created_ms)
VALUES (1, randomblob(16), CAST(unixepoch('subsec') * 1000 AS INTEGER));
