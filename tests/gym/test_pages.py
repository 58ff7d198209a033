"""The pages of the environments: what they show runs, and their tables are what there is."""

import contextlib
import inspect
import io
import re
from pathlib import Path

import gymnasium
import pytest

from visitlab_cli.gym import ENVIRONMENTS
from visitlab_cli.gym.environment import Environment
from visitlab_cli.gym.places import PLACES

PAGES = Path(__file__).parents[2] / "docs" / "environments"
TASKS = dict(zip(PLACES, ENVIRONMENTS, strict=True))
HEADINGS = [
    "Action space",
    "Observation space",
    "Rewards",
    "Starting state",
    "Episode end",
    "Arguments",
    "Version history",
]
BLOCK = re.compile(r"```python\n(.*?)```\n+(?:```text\n(.*?)```)?", re.DOTALL)


@pytest.mark.parametrize("page", sorted(PAGES.glob("*.md")), ids=lambda page: page.stem)
def test_what_a_page_shows_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {}
    blocks = BLOCK.findall(page.read_text())
    assert blocks
    for code, expected in blocks:
        told = io.StringIO()
        with contextlib.redirect_stdout(told):
            exec(compile(code, page.name, "exec"), names)
        assert told.getvalue() == expected


@pytest.mark.parametrize("task", PLACES)
def test_a_page_has_faramas_form_and_names_every_argument(task):
    page = (PAGES / f"{task}.md").read_text()
    found = [heading for heading in re.findall(r"^## (.*)$", page, re.MULTILINE) if heading in HEADINGS]
    assert found == HEADINGS
    table = page[page.index("## Arguments") :]
    named = re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE)
    own = list(inspect.signature(PLACES[task]).parameters)
    shared = [name for name in inspect.signature(Environment.__init__).parameters if name not in ("self", "settings")]
    assert named == own + shared
    assert TASKS[task] in page
    assert (PAGES / "index.md").read_text().count(f"{task}.md") == 1


@pytest.mark.parametrize("task", PLACES)
def test_a_page_tells_the_spaces(task):
    page = (PAGES / f"{task}.md").read_text()
    environment = gymnasium.make(TASKS[task])
    assert f"| action space | `{environment.action_space}` |" in page
    assert f"| observation space | `{environment.observation_space}` |" in page
    parts = gymnasium.make(TASKS[task], observation="dict").observation_space
    rows = dict(re.findall(r"^\| `(\w+)` \| `((?:Discrete|Box|MultiDiscrete)\(.*?\))` \|", page, re.MULTILINE))
    assert rows == {name: repr(space).replace("[8 8]", "[8, 8]") for name, space in parts.items()}
