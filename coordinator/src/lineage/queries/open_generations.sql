-- open_generations: where outcomes may still come from, and the names of what their stage measures.
SELECT g.first, g.size, g.stage, s.traits, s.measures
FROM generation AS g JOIN stage AS s ON s.id = g.stage
WHERE g.ended_ms IS NULL
