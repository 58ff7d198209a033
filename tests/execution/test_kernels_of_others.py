"""Kernels of another package: an edit takes effect at once, and what is kept of ours stays as it is."""

import json
import subprocess
import sys
from itertools import count
from typing import NamedTuple

import numpy as np
import pytest

from tests.program import the_run, visitlab
from visitlab_cli.random_numbers import random_state
from visitlab_cli.sources import is_sources, sources
from visitlab_cli.world.lab import RANDOM_CELL, paper_lab, random_cell

KIND = '''"""Adds to what it believes of an action whenever it takes it."""

from typing import Literal, NamedTuple

from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters, zeros
from visitlab_cli.agents.exploration import Table, epsilon_greedy
from visitlab_cli.compiled import kernel


class Adder(NamedTuple):
    q: Table


class AdderParameters(AgentParameters):
    """Adds."""

    kind: Literal["adder"]

    def create(self, setting):
        return Adder(zeros(setting))

    def save(self, record):
        return {"q": record.q}


@kernel
def more(value):
    return value + STEP


@CHOOSE.of(Adder)
def choose(agent, state, step, random):
    return epsilon_greedy(agent.q[state], 0.1, random)


@LEARN.of(Adder)
def learn(agent, state, action, reward, next_state, end, step, random):
    agent.q[state, action] = more(agent.q[state, action])
'''
IN = "import visitlab_cli.agents\nvisitlab_cli.agents.__path__.append({!r})\n"
CONFIG = """name: others
agents: {{one: {{kind: {kind}}}, two: {{kind: {kind}}}}}
experiments: {{navigation: {{task: navigation, agents: [one, two], steps: 200}}}}
"""


@pytest.fixture
def played(tmp_path):
    """Trains two agents of a kind in two processes, `adder`'s steps being as given: sums of Q, sources, stderr."""
    theirs, start = tmp_path / "theirs", tmp_path / "start"
    theirs.mkdir()
    start.mkdir()
    environment = {"VISITLAB_CACHE": str(tmp_path / "cache"), "PYTHONPATH": str(start)}

    outs = (tmp_path / str(number) for number in count())

    def play(kind, step=None):
        (start / "sitecustomize.py").unlink(missing_ok=True)
        if step is not None:
            (theirs / "adder.py").write_text(KIND.replace("STEP", str(step)))
            (start / "sitecustomize.py").write_text(IN.format(str(theirs)))
        (tmp_path / "config.yaml").write_text(CONFIG.format(kind=kind))
        out = next(outs)
        done = visitlab("run", tmp_path / "config.yaml", "--out", out, "--workers", 2, cwd=tmp_path, env=environment)
        assert done.returncode == 0, done.stderr
        cells = [the_run(out) / "navigation" / name / "seed-0000" for name in ("one", "two")]
        (made_by,) = {json.loads((cell / "cell.json").read_text())["sources"] for cell in cells}
        return [np.load(cell / "model.npz")["q"].sum() for cell in cells], made_by, done.stderr

    return play


def kept(cache):
    """The kept files of each folder of machine code."""
    return {
        folder.name: {file.name: file.read_bytes() for file in folder.rglob("*") if file.is_file()}
        for folder in cache.iterdir()
    }


@pytest.mark.slow
def test_an_edit_takes_effect_at_once_and_ours_stays_as_it_is(played, tmp_path):
    _, made_by, told = played("q_learning")
    assert made_by == sources()
    assert "compiling" in told
    ours = kept(tmp_path / "cache")
    assert len(ours) == 1
    (name,) = ours
    seen = {}
    for step in (1, 2):
        sums, seen[step], told = played("adder", step)
        assert sums == [200 * step] * 2
        assert "compiling" in told
    folders = kept(tmp_path / "cache")
    assert len(folders) == 3
    assert {file: folders[name].get(file) for file in ours[name]} == ours[name]
    assert len({made_by, *seen.values()}) == 3
    assert all(map(is_sources, seen.values()))
    for step in (1, 2):  # and back: nothing of it is stale, nothing is compiled again
        sums, again, told = played("adder", step)
        assert (sums, again) == ([200 * step] * 2, seen[step])
        assert "compiling" not in told
    with_them_there = played("q_learning", 2)
    assert (with_them_there[1], "compiling" in with_them_there[2]) == (made_by, False)
    assert played("q_learning")[1] == made_by
    assert kept(tmp_path / "cache") == folders


def test_code_without_a_file_is_compiled_each_time():
    code = (
        "from visitlab_cli.compiled import kernel, place_of, cache_place\n"
        "exec('def f(x): return x')\n"
        "print(place_of([]) == cache_place(), place_of([], f).folder, kernel(f)(3))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "True None 3\n"


class Even(NamedTuple):
    number: int = 0


@RANDOM_CELL.of(Even)
def even_cell(walls, rows, cols, random):
    drawn = np.zeros(2, np.int64)
    drawn[:] = walls.number
    return int(drawn.sum()), len(drawn.copy())


def test_code_of_others_may_make_arrays_though_ours_which_calls_it_counts_no_references():
    assert random_cell(paper_lab()._replace(walls=Even(3)), random_state(0, "cell")) == (6, 2)
