"""What the dispatch peers share: the payload, the busy work, the repeats and the JSON line. It starts no
workers itself."""

import argparse
import json
import math
import time

PAYLOAD_BYTES = 2048
WORKERS = 2


def evaluate(payload, work_ms):
    """One evaluation: a 2 KB genotype in, a fitness out; busy on the processor for so many milliseconds."""
    until = time.perf_counter() + work_ms / 1000.0
    while time.perf_counter() < until:
        pass
    return len(payload) / PAYLOAD_BYTES


def measure(layer, run):
    """Times `run(payloads, work_ms)` on no-op, 1 ms and 10 ms evaluations, the best of several repeats."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=3.0, help="about how long one repeat takes")
    parser.add_argument("--repeats", type=int, default=3, help="the best of so many is reported")
    arguments = parser.parse_args()
    for work_ms in (0.0, 1.0, 10.0):
        per_second = 4000 if work_ms == 0.0 else WORKERS * 1000 / work_ms
        count = max(int(per_second * arguments.seconds * 0.8), 20)
        payloads = [bytes([i % 256]) * PAYLOAD_BYTES for i in range(count)]
        run(payloads[:20], work_ms)  # workers are up and warm
        best = math.inf
        for _ in range(arguments.repeats):
            before = time.perf_counter()
            assert run(payloads, work_ms) == float(count), "every payload comes back whole"
            best = min(best, time.perf_counter() - before)
        print(json.dumps({
            "bench": "dispatch", "layer": layer, "workers": WORKERS, "work_ms": work_ms,
            "payload_bytes": PAYLOAD_BYTES, "evaluations": count, "per_second": round(count / best),
            "efficiency": round(count * work_ms / 1000 / (WORKERS * best), 4) if work_ms else None,
        }), flush=True)
