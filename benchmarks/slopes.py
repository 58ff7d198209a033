"""How cost grows with the size of the grid, with steps, seeds and workers: slopes of log cost over log size.

    python -m benchmarks.slopes

A slope of 1 is proportional, 0 does not grow. Grids, steps: CPU of playing. Seeds: CPU of the whole command above
that of a command with one seed. Workers: the clock of the whole command, which needs that many free cores.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from benchmarks.cases import Case, in_new_process
from benchmarks.rows import Row, number, show

SIZES = (4, 8, 16)  # cells along a room; 3 x 3 rooms, 48 the most along a lab
STEPS = (250_000, 500_000, 1_000_000, 2_000_000)
SEEDS = (8, 32, 128)
SOCIAL_CELLS, SOCIAL_STEPS = 32, 2_000_000
CONFIG = """
name: slopes
seeds: {seeds}
humans: {{h: {{p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}}}}
agents: {{mb: {{kind: model_based}}}}
experiments: {{social: {{task: social, agents: [mb], humans: [h], steps: {steps}}}}}
record: {{steps: {record}}}
"""


def slope(sizes: list[float], costs: list[float]) -> float:
    """Of log cost over log size, least squares."""
    return float(np.polyfit(np.log(sizes), np.log(costs), 1)[0])


def told(sizes: list[float], costs: list[float]) -> str:
    """The first and the last of them."""
    return f"{number(costs[0])} s of {number(sizes[0])}, {number(costs[-1])} s of {number(sizes[-1])}"


def of_run(seeds: int, steps: int, workers: int, record: str = "every") -> tuple[float, float]:
    """Seconds of CPU and of the clock of a whole `visitlab run`, compiled before."""
    with tempfile.TemporaryDirectory() as name:
        config = Path(name) / "slopes.yaml"
        config.write_text(CONFIG.format(seeds=seeds, steps=steps, record=record))
        command = [sys.executable, "-m", "visitlab_cli", "run", str(config), "--out", name, "--quiet"]
        before, begun = _children(), time.perf_counter()
        subprocess.run([*command, "--workers", str(workers)], check=True, stdout=subprocess.DEVNULL, env=os.environ)
        return _children() - before, time.perf_counter() - begun


def _children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rows() -> Iterator[Row]:
    """A slope each."""
    for task, agent in (("navigation", {"kind": "q_learning"}), ("navigation", {"kind": "model_based"})):
        cells, costs = [], []
        for size in SIZES:
            lab = {"labs": {"grid": {"rooms": "3 x 3", "size": f"{size} x {size}", "walls": "none"}}}
            found = in_new_process(Case(task, agent, 1_000_000, {"lab": "grid"}, **lab))
            cells.append(float((3 * size) ** 2))
            costs.append(found["seconds"])
        what = f"{task} {agent['kind']}, cells of the lab"
        yield Row(what, slope(cells, costs), "slope", told(cells, costs))
    for task, agent in (("navigation", {"kind": "q_learning"}), ("social", {"kind": "model_based"})):
        costs = [in_new_process(Case(task, agent, steps))["seconds"] for steps in STEPS]
        what = f"{task} {agent['kind']}, steps"
        yield Row(what, slope(list(STEPS), costs), "slope", told(list(STEPS), costs))
    of_run(1, 2_000, 1)
    least = of_run(1, 20_000, 1)[0]
    costs = [of_run(seeds, 20_000, 1)[0] - least for seeds in SEEDS]
    more = [seeds - 1 for seeds in SEEDS]
    yield Row("social model_based of 20,000 steps, seeds", slope(more, costs), "slope", told(more, costs))
    for record, wanted in (("none", "1.85"), ("every", "")):
        one, two = (of_run(SOCIAL_CELLS, SOCIAL_STEPS, workers, record)[1] for workers in (1, 2))
        how = "not recorded" if record == "none" else "recorded, which one worker does beside playing"
        what = f"{SOCIAL_CELLS} social cells, two workers, {how}"
        yield Row(what, one / two, "times as fast", f"one worker {number(one)} s, two {number(two)} s", None, wanted)


if __name__ == "__main__":
    show(rows())
