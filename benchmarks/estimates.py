"""What whole cells cost, each kind of agent in each task, beside what a plan takes them to cost.

    python -m benchmarks.estimates [PART OF A NAME ...]

Plans are told from `microseconds_a_step` of the kinds and `seconds` of the tasks: where a ratio is far from 1, those
should be mended. What is measured is the CPU time of a cell beyond that of one of a few steps, compiled before.
"""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.cases import Case
from benchmarks.rows import Row, number, show

STEPS = {"navigation": 400_000, "go_to_human": 400_000, "social": 400_000, "visit": 100_000}
FEW = 2_000


def cell_seconds(task: str, kind: str) -> tuple[float, float]:
    """The CPU time of a cell of a few steps and of a usual one, files and all; the second of two of each."""
    import yaml

    from visitlab_cli.config.loading import load
    from visitlab_cli.execution.cell_runner import run_cell
    from visitlab_cli.plan.cells import plan

    seconds = []
    with tempfile.TemporaryDirectory() as name:
        file = Path(name) / "case.yaml"
        for steps in (FEW, STEPS[task]):
            file.write_text(
                yaml.safe_dump({**Case(task, {"kind": kind}, steps).config(steps), "seeds": 2, "record": {}})
            )
            for cell in plan(load(file)):
                begun = time.process_time()
                run_cell(Path(name) / str(steps), cell, lambda steps: None)
                if cell.task == task:
                    latest = time.process_time() - begun
            seconds.append(latest)
    return seconds[0], seconds[1]


def rows(parts: Sequence[str] = ()) -> Iterator[Row]:
    """A kind in a task each; those with all `parts` in their names. What refers to other agents is left out."""
    from visitlab_cli.agents.registry import KINDS
    from visitlab_cli.world.tasks import TASKS

    for word, kind in KINDS.items():
        for task, told in kind.microseconds_a_step.items():
            name = f"{word} in {task}"
            if word == "observer" or not all(part in name for part in parts):
                continue
            program = f"import json, benchmarks.estimates as e; print(json.dumps(e.cell_seconds({task!r}, {word!r})))"
            done = subprocess.run([sys.executable, "-c", program], check=True, stdout=subprocess.PIPE, text=True)
            least, usual = json.loads(done.stdout)
            step = 1e6 * (usual - least) / (STEPS[task] - FEW)
            yield Row(f"a step of {name}", step, "microseconds", f"told {number(told)}", step / told)
            fixed = TASKS[task].costs.seconds
            yield Row(f"a cell of {name}", least, "s", f"told {number(fixed)}", least / fixed)


if __name__ == "__main__":
    show(rows(sys.argv[1:]))
