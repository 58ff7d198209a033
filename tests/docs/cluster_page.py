"""docs/cluster.md: its script is what the command on the page writes, in a folder that the page calls its own."""

import os
import re
import shlex
import sys
from pathlib import Path

from tests.jobs.queues import queue
from tests.program import the_run, visitlab

PAGE = Path(__file__).parents[2] / "docs" / "cluster.md"
PLACE, PYTHON = "/scratch/lab", "/scratch/lab/.venv/bin/python"
SCRIPT = re.compile(r"(?<=```bash\n).*?(?=```)", re.DOTALL)
SHOWN = "visitlab submit quickstart seeds=400 --slurm"


def blocks() -> list[list[str]]:
    """The commands of the page, in order, block by block."""
    found = re.findall(r"```console\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    return [[line.removeprefix("$ ") for line in block.splitlines()] for block in found]


def with_queue(folder: Path, *, runs: bool) -> dict[str, str]:
    """The variables with which the queues' programs are those of `folder`, which really run jobs or don't."""
    for name in ("sbatch", "qsub"):
        queue(folder, name, runs)
    return {"PATH": f"{folder}{os.pathsep}{os.environ['PATH']}"}


def cluster_page(folder: Path) -> str:
    """The page with the script as it is written now."""
    place = folder / "cluster"
    place.mkdir()
    (command,) = (each for block in blocks() for each in block if each.startswith(SHOWN))
    done = visitlab(*shlex.split(command)[1:], cwd=place, env=with_queue(folder / "queue", runs=False))
    assert done.returncode == 0, done.stderr
    text = (the_run(place / "runs") / "jobs" / "slurm.sh").read_text(encoding="utf-8")
    text = text.replace(sys.executable, PYTHON).replace(str(place), PLACE)
    return SCRIPT.sub(lambda _: text, PAGE.read_text(encoding="utf-8"), count=1)
