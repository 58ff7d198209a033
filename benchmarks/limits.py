"""What the machine could do at most, and how near the simulation comes: random numbers, memory, compiled calls.

    python -m benchmarks.limits

A step's random numbers are counted (the generator counts its own draws) and priced at what a draw costs in a loop of
its own; what a sweep must at least read is priced at the speed at which as much memory is read in order.
"""

import json
import subprocess
import sys
import time
from collections.abc import Iterator

from benchmarks.cases import Case, in_new_process
from benchmarks.rows import Row, number, show

DRAWS = 20_000_000
BYTES = 2**20, 2**24, 2**28
ROUNDS = 5
PLAYED = {
    "navigation q_learning": Case("navigation", {"kind": "q_learning"}, 4_000_000),
    "social q_learning": Case("social", {"kind": "q_learning"}, 2_000_000),
    "social model_based, no sweeps": Case("social", {"kind": "model_based", "plan_every": 10**9}, 1_000_000),
    "visit model_based, no sweeps": Case("visit", {"kind": "model_based"}, 1_000_000, {"plan_every": 10**9}),
}


def of_machine() -> dict[str, float]:
    """Nanoseconds of a draw; bytes a second of reading in order, and nanoseconds of a read anywhere, by size."""
    import numba
    import numpy as np

    from visitlab_cli.random_numbers import random_state, random_unit

    @numba.njit(nogil=True)
    def draw(state, count):
        total = 0.0
        for _ in range(count):
            total += random_unit(state)
        return total

    @numba.njit(nogil=True)
    def read(words, times):
        total = 0
        for _ in range(times):
            for word in words:
                total += word
            words[0] = total  # else the compiler reads once
        return total

    @numba.njit(nogil=True)
    def follow(after, count):
        place = 0
        for _ in range(count):
            place = after[place]
        return place

    def least(call, *arguments):
        call(*arguments)
        seconds = []
        for _ in range(ROUNDS):
            begun = time.perf_counter()
            call(*arguments)
            seconds.append(time.perf_counter() - begun)
        return min(seconds)

    found = {"draw": 1e9 * least(draw, random_state(0, "limits"), DRAWS) / DRAWS}
    for size in BYTES:
        words = np.ones(size // 8, np.int64)
        times = max(1, 2**28 // size)
        found[f"read {size}"] = size * times / least(read, words, times)
        order = np.random.default_rng(0).permutation(len(words))
        after = np.empty(len(words), np.int64)
        after[order] = np.roll(order, -1)
        found[f"latency {size}"] = 1e9 * least(follow, after, 2_000_000) / 2_000_000
    return found


def rows() -> Iterator[Row]:
    """The machine, then how a step's time divides."""
    command = [
        sys.executable,
        "-c",
        "import json; from benchmarks.limits import of_machine; print(json.dumps(of_machine()))",
    ]
    machine = json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout)
    yield Row("a random number", machine["draw"], "ns")
    for size in BYTES:
        where = f"{size / 2**20:.0f} MiB"
        yield Row(f"reading {where} in order", machine[f"read {size}"] / 1e9, "GB/s")
        yield Row(f"a read anywhere in {where}, one after the other", machine[f"latency {size}"], "ns")
    for name, case in PLAYED.items():
        found = in_new_process(case)
        step = 1e9 * found["seconds"] / found["steps"]
        least = found["draws"] * machine["draw"]
        beside = f"{found['draws']:.2f} random numbers, {number(least)} ns"
        yield Row(f"a step of {name}", step, "ns", beside, step / least)


if __name__ == "__main__":
    show(rows())
