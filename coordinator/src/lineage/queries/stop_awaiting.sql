-- stop_awaiting: an experiment that waited for a pick goes on when one is made.
UPDATE experiment SET state = 'running', reason = '' WHERE id = ? AND state = 'awaiting'
