"""What the machine could do at most, and how near the simulation comes: random numbers, memory, compiled calls.

    python -m benchmarks.limits

A step's random numbers are counted (the generator counts its own draws) and priced at what a draw costs in a loop of
its own; what a sweep must at least read and write is priced at the speed at which as much memory is read in order.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from benchmarks import cases
from benchmarks.cases import Case
from benchmarks.rows import Row, number, show

DRAWS = 20_000_000
BYTES = 2**20, 2**24, 2**28
ROUNDS = 5
OF_A_PAIR = 8 + 4 + 8 + 8 + 4 + 8
"""Bytes of each pair that a sweep needs: its Q, visits, mean reward, where its row begins, its length; its new Q."""
OF_A_SUCCESSOR = 4 + 4
"""Its state and its count."""
SWEPT = Case("social", {"kind": "model_based"}, 1_000_000)
PLAYED = {
    "navigation q_learning": Case("navigation", {"kind": "q_learning"}, 4_000_000),
    "social q_learning": Case("social", {"kind": "q_learning"}, 2_000_000),
    "social model_based, no sweeps": Case("social", {"kind": "model_based", "plan_every": 10**9}, 1_000_000),
    "visit model_based, no sweeps": Case("visit", {"kind": "model_based"}, 1_000_000, {"plan_every": 10**9}),
}


def least(call: Callable[..., Any], *arguments: Any) -> float:
    """Seconds of the fastest of some calls, after one that compiles."""
    call(*arguments)
    seconds = []
    for _ in range(ROUNDS):
        begun = time.perf_counter()
        call(*arguments)
        seconds.append(time.perf_counter() - begun)
    return min(seconds)


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


def of_sweep() -> dict[str, float]:
    """Seconds of a sweep of what `SWEPT` has learned; its pairs, those that it tried, and their successors."""
    import numba
    import numpy as np
    import yaml

    from visitlab_cli.agents.base import Setting
    from visitlab_cli.agents.sparse_model import restored_model, sweep
    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.plan.cells import plan

    @numba.njit(nogil=True)
    def sweeps(model, q, values, times):
        for _ in range(times):
            sweep(model, q, values, 0.9, 1, True)

    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "case.yaml"
        file.write_text(yaml.safe_dump(SWEPT.config(SWEPT.steps)))
        (cell,) = plan(load(file))
        run_cell(Path(name) / "run", cell, lambda steps: None)
        with np.load(Path(name) / "run" / cell.path / "model.npz") as saved:
            learned = dict(saved)
    q = learned["q"].copy()
    model = restored_model(Setting(SWEPT.task, *q.shape, 0), learned)
    times = 50
    return {
        "seconds": least(sweeps, model, q, np.zeros(len(q)), times) / times,
        "pairs": q.size,
        "tried": int((model.visits > 0).sum()),
        "successors": len(learned["successor_states"]),
    }


def in_new_process(measure: str) -> dict[str, float]:
    """What a function of this module gives, called in a process of its own."""
    program = f"import json; from benchmarks.limits import {measure}; print(json.dumps({measure}()))"
    done = subprocess.run([sys.executable, "-c", program], check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


def rows() -> Iterator[Row]:
    """The machine, then how a step's time divides, and a sweep's."""
    machine = in_new_process("of_machine")
    yield Row("a random number", machine["draw"], "ns")
    for size in BYTES:
        where = f"{size / 2**20:.0f} MiB"
        yield Row(f"reading {where} in order", machine[f"read {size}"] / 1e9, "GB/s")
        yield Row(f"a read anywhere in {where}, one after the other", machine[f"latency {size}"], "ns")
    for name, case in PLAYED.items():
        found = cases.in_new_process(case)
        step = 1e9 * found["seconds"] / found["steps"]
        drawing = found["draws"] * machine["draw"]
        beside = f"{found['draws']:.2f} random numbers, {number(drawing)} ns"
        yield Row(f"a step of {name}", step, "ns", beside, step / drawing)
    found = in_new_process("of_sweep")
    touched = OF_A_PAIR * found["pairs"] + OF_A_SUCCESSOR * found["successors"]
    reading = touched / machine[f"read {BYTES[1]}"]
    what = f"a sweep of {found['tried']:,} tried pairs, {found['successors']:,} successors"
    beside = f"{touched / 2**20:.3g} MiB in order, {1e3 * reading:.3g} ms"
    yield Row(what, 1e3 * found["seconds"], "ms", beside, found["seconds"] / reading)


if __name__ == "__main__":
    show(rows())
