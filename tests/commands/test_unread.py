"""A cell that a command's numbers lack, damaged or not run, is told by every command that reads results."""

import shutil

import pytest

from tests.program import visitlab

DAMAGED, MISSING = "social/mb/fast/seed-0000", "visit/fast/seed-0000"
BOTH = f"2 of 17 cells not read: 1 damaged ({DAMAGED}), 1 not run yet ({MISSING})"
COMMANDS = {
    "compare --by agent": BOTH,
    "compare": BOTH,
    "export --csv -o a.csv": BOTH,
    "export --parquet --table results -o a.parquet": BOTH,
    "report": BOTH,
    "report --json": BOTH,
    "figures --only fig6": BOTH,
    "runs show": BOTH,
    "runs show --json": BOTH,
    "metrics": f"2 of 9 cells not read: 1 damaged ({DAMAGED}), 1 not run yet ({MISSING})",
    "metrics -e visit": f"1 of 2 cells not read: 1 not run yet ({MISSING})",
    "metrics -e visit_scripted": "",
    "affordances --agent rmax": "",
    "replay --save a.rrd": f"1 of 3 cells not read: 1 not run yet ({MISSING})",
    "steps -e social": f"1 of 6 cells not read: 1 damaged ({DAMAGED})",
    "export --foxglove -o a.mcap": f"1 of 3 cells not read: 1 not run yet ({MISSING})",
}


@pytest.fixture(scope="module")
def run(tiny_run, tmp_path_factory):
    """A copy of the tiny run; of one cell a file is cut, another is not there."""
    copy = shutil.copytree(tiny_run, tmp_path_factory.mktemp("runs") / tiny_run.name)
    log = copy / DAMAGED / "steps.mcap"
    log.write_bytes(log.read_bytes()[:-100])
    shutil.rmtree(copy / MISSING)
    return copy


@pytest.mark.parametrize(("command", "told"), COMMANDS.items(), ids=COMMANDS)
def test_what_is_not_read_is_told(run, tmp_path, command, told):
    words = command.split()
    first = 2 if words[0] == "runs" else 1
    others = [run] if words == ["compare"] else []
    done = visitlab(*words[:first], run, *others, *words[first:], cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if "not read" in line]
    again = f"visitlab run {run}/config.yaml --out {run.parent} makes what is missing"
    assert lines == ([f"{run}: {told}; {again}"] if told else [])


def test_nothing_is_told_of_a_whole_run(tiny_run):
    for words in (["runs", "show"], ["metrics"], ["compare", tiny_run]):
        done = visitlab(*words, tiny_run)
        assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(("played", "holds"), [(0, "1 cell"), (2, "1 cell and 2 of evaluations")])
def test_rm_counts_as_list_does(tiny_run, tmp_path, played, holds):
    run = tmp_path / tiny_run.name
    for number in range(played):
        cell = run / f"evaluations/01234567/visit/fast/seed-000{number}"
        shutil.copytree(tiny_run / MISSING, cell)
    shutil.copytree(tiny_run / MISSING, run / MISSING)
    for name in ("config.yaml", "versions.json"):
        shutil.copy(tiny_run / name, run / name)
    done = visitlab("runs", "rm", run, "--yes")
    assert done.returncode == 0, done.stderr
    assert f"({holds}, " in done.stdout
