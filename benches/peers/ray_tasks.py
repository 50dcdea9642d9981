"""Ray tasks under the load of `hatchery-benches`' dispatch bench: 2 KB payloads, two workers of one processor
each on this machine. One JSON line a kind of work. Nothing is stored."""

import os

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # no reports to anyone

import ray

from dispatch import WORKERS, evaluate, measure

WINDOW = 1000  # tasks submitted ahead of the results taken


def run(payloads, work_ms):
    pending, total = [], 0.0
    for payload in payloads:
        pending.append(remote_evaluate.remote(payload, work_ms))
        if len(pending) >= WINDOW:
            ready, pending = ray.wait(pending, num_returns=WINDOW // 2)
            total += sum(ray.get(ready))
    return total + sum(ray.get(pending))


if __name__ == "__main__":
    ray.init(num_cpus=WORKERS, include_dashboard=False, log_to_driver=False, logging_level="error")
    remote_evaluate = ray.remote(num_cpus=1)(evaluate)
    measure("ray tasks", run)
    ray.shutdown()
