-- no_run_is_over: of an experiment whose search may now have more to ask.
UPDATE stage SET over = 0 WHERE experiment = ?
