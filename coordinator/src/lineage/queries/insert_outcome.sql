-- insert_outcome: one row an individual, written once; a second report changes nothing.
INSERT INTO outcome (individual, status, fitness, fitness_bits, steps, measures, interim_step, interim_measure,
    verdict, note, attempt, worker, micros)
VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)
ON CONFLICT (individual) DO NOTHING
