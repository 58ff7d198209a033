"""The commands of docs/tutorial.md and their output, and running them."""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

from tests.program import COMMAND

PAGE = Path(__file__).parents[2] / "docs" / "tutorial.md"
BLOCK = re.compile(r"^```console(?: exit=(\d+))?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
RUN = "visitlab run my-human.yaml"


class Shown(NamedTuple):
    """A command of the page, the exit code that it should have, and what the page says that it prints."""

    command: str
    code: int
    output: str


def shown(page: str) -> list[Shown]:
    """The commands of a page in order, one for each block."""
    found = []
    for code, text in BLOCK.findall(page):
        command, _, output = text.removeprefix("$ ").partition("\n")
        found.append(Shown(command, int(code or 0), output))
    return found


def small_size(page: str) -> str:
    """The overrides that the page names."""
    return " ".join(re.search(r"with `(seeds=[^`]*)` after `visitlab run", page)[1].split())


def run(command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command of the page in bash in `folder`."""
    script = f'set -o pipefail; visitlab() {{ "{COMMAND[0]}" -m visitlab_cli "$@"; }}; {command}'
    environment = os.environ | {"NO_COLOR": "1", "PYTHONPATH": os.pathsep.join(sys.path)}
    return subprocess.run(
        ["bash", "-c", script], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def made_anew(page: str, folder: Path) -> str:
    """The page with what its commands print now, at full size."""
    for each in shown(page):
        done = run(each.command, folder)
        assert done.returncode == each.code, f"{each.command}: {done.stderr}"
        output = done.stderr if each.code else done.stdout
        page = page.replace(f"$ {each.command}\n{each.output}```", f"$ {each.command}\n{output.rstrip()}\n```")
    return page
