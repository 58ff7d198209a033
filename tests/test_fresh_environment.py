"""The packages in `examples/`, by pip, in an environment with nothing else: what a user of theirs does with them."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.packages import EXAMPLES
from tests.program import hashes, only_cells, the_run

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
KINDS = {
    "visitlab-sarsa": ("sarsa.yaml", ["sarsa_plain"], []),
    "visitlab-more": ("more.yaml", ["double_q"], ["tiring", "curious"]),
}
SHORT = ["seeds=1", "experiments.navigation.steps=20000", "experiments.go_to_human.steps=20000"]
SHORT += ["experiments.social.steps=40000", "experiments.visit.trials=5"]


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    """The command of an environment in which visitlab and both packages are installed."""
    folder = tmp_path_factory.mktemp("fresh")
    subprocess.run([sys.executable, "-m", "venv", folder / "venv"], check=True)
    install = [folder / "venv" / "bin" / "python", "-m", "pip", "install", "--quiet"]
    subprocess.run([*install, "--constraint", ROOT / "constraints.txt", ROOT], check=True)
    subprocess.run([*install, *(EXAMPLES / name for name in KINDS)], check=True)
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "VIRTUAL_ENV")}

    def command(*arguments, start=False):
        run = subprocess.Popen(
            [folder / "venv" / "bin" / "visitlab", *map(str, arguments)],
            cwd=folder,
            env=environment | {"NO_COLOR": "1"},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        if start:
            return run
        out, told = run.communicate(timeout=1200)
        assert run.returncode == 0, (arguments, out, told)
        return out

    return command


@pytest.mark.parametrize("name", KINDS)
def test_it_is_all_that_it_says(program, name, tmp_path):
    config, agents, humans = KINDS[name]
    for section, kinds in (("agents", agents), ("humans", humans)):
        listed = json.loads(program(section, "--json"))[section]
        assert {each["kind"] for each in listed if each["package"] == name} == set(kinds)
    for kind in agents:
        program("plugin", "check", kind)
    asked = ["run", EXAMPLES / name / config, *SHORT, "--workers", 2]
    program(*asked, "--out", tmp_path / "whole")
    whole = the_run(tmp_path / "whole")

    stopped = program(*asked, "--out", tmp_path / "again", start=True)
    for line in stopped.stderr:
        if "reward a trial" in line:
            break
    stopped.send_signal(signal.SIGINT)
    stopped.communicate(timeout=60)
    assert stopped.returncode == 130
    again = the_run(tmp_path / "again")
    assert 0 < len(only_cells(hashes(again))) < len(only_cells(hashes(whole)))
    program(*asked, "--out", tmp_path / "again")
    assert only_cells(hashes(again)) == only_cells(hashes(whole))

    program("eval", whole, "--frozen", "--trials", 2)
    program("replay", whole, "--trial", 1, "--save", tmp_path / "trial.rrd")
    compared = json.loads(program("compare", whole, "--by", "agent", "--json"))
    assert {pair[side]["name"] for pair in compared["pairs"] for side in ("first", "second")} >= {"mf", "mb"}
    program("runs", "verify", whole)

    for kind in agents:
        asked = ["score", kind, "--only", "navigation", "--only", "go_to_human", "--seeds", 1]
        (scored,) = json.loads(program(*asked, "--out", tmp_path / "scores", "--json"))["agents"]
        assert scored["kind"] == kind
        assert {row["row"]: row["score"]["mean"] > 0.2 for row in scored["rows"]} == {
            "navigation": True,
            "go_to_human": True,
        }
