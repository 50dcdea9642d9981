-- quarantined_names: workers that are trusted no more.
SELECT DISTINCT name FROM worker WHERE quarantined_ms IS NOT NULL ORDER BY name
