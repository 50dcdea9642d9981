-- insert_outcome: one row an individual, written once; a second report changes nothing.
INSERT INTO outcome (individual, status, fitness, fitness_bits, steps, interim_step, interim_measure, verdict, note,
    attempt, worker, micros, audit, m0, m1, m2, m3, m4, m5, m6, m7, m8, m9, m10, m11, measures)
VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)
ON CONFLICT (individual) DO NOTHING
