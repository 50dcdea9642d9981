-- find_finished: the latest finished experiment of a resolved file in the matrix of another.
SELECT cell.id
FROM experiment AS other
JOIN experiment AS cell ON cell."group" = other."group"
WHERE other.id = ? AND cell.digest = ? AND cell.state = 'finished'
ORDER BY cell.id DESC LIMIT 1
