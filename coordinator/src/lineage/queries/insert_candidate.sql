-- insert_candidate: who may go on from the end of a stage.
INSERT INTO candidate (experiment, stage, rank, individual, fitness, notes) VALUES (?, ?, ?, ?, ?, ?)
