-- generation_places: where the generations of a JSON list stand.
SELECT g.id, s.number, g.number, g.first
FROM json_each(?1) AS a
CROSS JOIN generation AS g ON g.id = a.value
JOIN stage AS s ON s.id = g.stage
