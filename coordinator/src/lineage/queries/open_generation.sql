-- open_generation: where a stage goes on, with the state of the search before it asked for it.
SELECT g.number, g.first, g.size, g.cull_at, g.cutoff,
    c.generation AS checkpoint_generation, c.size AS checkpoint_size, c.state
FROM generation AS g JOIN checkpoint AS c ON c.stage = g.stage
WHERE g.stage = ? AND g.ended_ms IS NULL
