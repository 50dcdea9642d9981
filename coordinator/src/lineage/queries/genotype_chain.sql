-- genotype_chain: a genotype and what it rests on, the full copy first. The limit is for damaged files alone.
WITH RECURSIVE chain (base, size, bytes, link) AS (
    SELECT base, size, bytes, 0 FROM genotype WHERE individual = ?
    UNION ALL
    SELECT g.base, g.size, g.bytes, chain.link + 1
    FROM chain JOIN genotype AS g ON g.individual = chain.base
    WHERE chain.link < 64
)
SELECT size, bytes FROM chain ORDER BY link DESC
