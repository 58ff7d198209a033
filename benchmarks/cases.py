"""What is measured of playing: a cell of a config, in a process of its own, after the kernels that it needs are there.

    python -m benchmarks.cases '{"task": "social", "agent": {"kind": "model_based"}, "steps": 500000}'

A case is played as a run plays it, by the same functions, and prints as JSON: the seconds of CPU of playing and
recording, in the fastest of three turns, bytes recorded, random numbers drawn.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

HUMAN_2 = {"p_S": [0, 0.5, 0.5], "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05}
LESSONS = {"navigation": 200_000, "go_to_human": 200_000, "social": 500_000}
FEW_LESSONS = 2_000  # uncompiled, training would take hours: the same sweep over a model of fewer successors
WARM_UP_STEPS = 200
TURNS = 3  # the fastest counts: what else runs on a machine only ever adds
TRAINED = "visit"


class Case(NamedTuple):
    """A task, an agent, and what else a config says of them; `lessons` of a visit: steps of each module's training."""

    task: str
    agent: dict[str, Any]
    steps: int
    more: dict[str, Any] = {}
    recorded: bool = False
    labs: dict[str, Any] = {}
    lessons: dict[str, int] = LESSONS

    def uncompiled(self, steps: int) -> "Case":
        """The same over fewer steps."""
        return self._replace(steps=steps, lessons=dict.fromkeys(LESSONS, FEW_LESSONS))

    def config(self, steps: int) -> dict[str, Any]:
        """The config of a case that plays `steps` steps."""
        experiments: dict[str, Any] = {}
        met = {"humans": ["human"]} if self.task in ("social", "visit") else {}
        if self.task == "visit":
            modules = {"navigation": "navigation/nav", "go_to_human": "go_to_human/nav", "social": "social/mine/human"}
            for module, lessons in self.lessons.items():
                agent, whom = ("mine", {"humans": ["human"]}) if module == "social" else ("nav", {})
                experiments[module] = {"task": module, "agents": [agent], "steps": lessons, **whom}
            experiments["visit"] = {"task": "visit", "modules": modules, "trials": max(1, steps // 100), **met}
        else:
            experiments[self.task] = {"task": self.task, "agents": ["mine"], "steps": steps, **met}
        experiments[self.task] |= self.more
        return {
            "name": "benchmark",
            "humans": {"human": HUMAN_2},
            "agents": {"mine": self.agent, "nav": {"kind": "model_based"}},
            "experiments": experiments,
            "record": {"steps": "none"},
            **({"labs": self.labs} if self.labs else {}),
        }


def measure(case: Case) -> dict[str, float]:
    """Play a case in this process; the modules of a visit are trained first, and are not measured."""
    import yaml

    from visitlab_cli.compiled import JIT_DISABLED
    from visitlab_cli.config.loading import load
    from visitlab_cli.plan.cells import plan

    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for steps, turns in ((WARM_UP_STEPS, 1), (case.steps, 1 if JIT_DISABLED else TURNS)):
            file = folder / "case.yaml"
            file.write_text(yaml.safe_dump(case.config(steps)))
            cells = plan(load(file))
            for cell in cells[:-1]:
                _train(folder / "run", cell)
            played = [_play(folder, cells[-1], recorded=case.recorded) for _ in range(turns)]
    return min(played, key=lambda found: found["seconds"])


def _train(run: Path, cell: Any) -> None:
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.storage.cell_folder import read_cell

    if read_cell(run / cell.path) is None:
        run_cell(run, cell, lambda steps: None)


def _play(folder: Path, cell: Any, *, recorded: bool) -> dict[str, float]:
    import numpy as np

    from visitlab_cli.execution.build import build
    from visitlab_cli.execution.cell_runner import simulate
    from visitlab_cli.log.writer import StepRecorder
    from visitlab_cli.plan.saved import modules_of
    from visitlab_cli.random_numbers import random_state

    simulation = build(cell, modules_of(folder / "run", cell))
    random = random_state(0, "benchmark")
    first = int(random[3])
    log = folder / "steps.mcap"
    log.unlink(missing_ok=True)
    begun, on_the_clock = time.process_time(), time.perf_counter()
    if recorded:
        with StepRecorder(log, cell.task, attributes={}, config_yaml=b"", parts=cell.parts) as recorder:
            simulate(simulation, random, recorder.write, lambda steps: None)
    else:
        simulate(simulation, random, lambda columns, rows: None, lambda steps: None)
    spent, wall = time.process_time() - begun, time.perf_counter() - on_the_clock
    return {
        "steps": cell.steps,
        "seconds": spent,
        "wall": wall,
        "bytes": log.stat().st_size if recorded else 0,
        "draws": float(np.uint64(int(random[3]) - first)) / cell.steps,  # the state's last word counts them
    }


def in_new_process(case: Case, **environment: str) -> dict[str, float]:
    """Measure a case in a process of its own."""
    command = [sys.executable, "-m", "benchmarks.cases", json.dumps(case._asdict())]
    done = subprocess.run(command, env=os.environ | environment, check=True, stdout=subprocess.PIPE, text=True)
    return json.loads(done.stdout)


def speed(case: Case, **environment: str) -> float:
    """Steps a second of CPU time."""
    found = in_new_process(case, **environment)
    return found["steps"] / found["seconds"]


if __name__ == "__main__":
    print(json.dumps(measure(Case(**json.loads(sys.argv[1])))))
