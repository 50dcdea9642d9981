-- open_generation: where a stage goes on.
SELECT g.number, g.first, g.size, g.cull_at, g.cutoff, s.task
FROM generation AS g JOIN stage AS s ON s.id = g.stage
WHERE g.stage = ? AND g.ended_ms IS NULL
