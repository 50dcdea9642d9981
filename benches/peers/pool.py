"""A Python process pool under the load of `hatchery-benches`' dispatch bench: 2 KB payloads, two processes.
One JSON line a kind of work, once handed out one by one and once in chunks of 64. Nothing is stored."""

from functools import partial
from multiprocessing import get_context

from dispatch import WORKERS, evaluate, measure


def run(pool, chunk, payloads, work_ms):
    return sum(pool.imap_unordered(partial(evaluate, work_ms=work_ms), payloads, chunksize=chunk))


if __name__ == "__main__":
    for chunk in (1, 64):
        with get_context("fork").Pool(WORKERS) as pool:
            measure(f"python process pool, chunks of {chunk}", partial(run, pool, chunk))
