"""Every table of the terminal shows what varies as short columns, and nothing twice."""

import pytest

from tests.commands.test_runs import rows, tell
from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.console.dry_run import _table as costs_table
from visitlab_cli.console.running import table
from visitlab_cli.plan.estimate import estimate
from visitlab_cli.results.expected import results
from visitlab_cli.storage.run_folder import read_config

VARY = """
vary:
  humans.slow.p_A: [0, 0.5]
  agents.mf.alpha: [0.1, 0.5]
  agents.mb: [{kind: model_based}, {kind: model_based, gamma: 0.5}]
"""
LONG = ("humans.", "agents.", "=0", "{")


@pytest.fixture(scope="module")
def grid(tmp_path_factory):
    run, cells = open_lab(tmp_path_factory.mktemp("grid"), seeds=2, models="first", more=VARY)
    reach(run, cells, {path: float(len(path)) + cell.seed for path, cell in cells.items()})
    return run, cells


def test_runs_show(grid):
    run, _ = grid
    code, out, _ = tell("runs", "show", run)
    assert code == 0
    head, *lines = rows(out.partition("\n\n")[2])
    assert head[:7] == ["experiment", "agent", "human", "p_A", "alpha", "gamma", "measure"]
    assert ["navigation", "mf", "-", "-", "0.5", "-"] in [line[:6] for line in lines]
    assert ["social", "mb", "slow", "0.5", "-", "0.5"] in [line[:6] for line in lines]
    assert not any(word in out.partition("\n")[2] for word in LONG)
    assert next(line[9] for line in lines if line[0] == "visit") == "1 model, 2 visits"
    assert "Visits of the same trained modules count as one" in out


def test_the_table_of_a_run_and_of_a_dry_run(grid):
    run, cells = grid
    told = table(results(run, read_config(run), list(cells.values())))
    assert rows(told)[0][:5] == ["module or visit", "p_A", "alpha", "gamma", "measure"]
    assert not any(word in told for word in LONG)
    groups = {cell.group: cell for cell in cells.values()}
    told = costs_table({group: estimate([cell], 1) for group, cell in groups.items()}, groups)
    assert rows(told)[0][:4] == ["module or visit", "p_A", "alpha", "gamma"]
    assert not any(word in told for word in LONG)


@pytest.mark.parametrize(
    ("key", "head", "first"),
    [
        ("humans.slow.p_A", ["where", "alpha", "gamma", "measure"], ["0.0", "0.5"]),
        ("agents.mb", ["where", "p_A", "alpha", "measure"], ["gamma=0.9", "gamma=0.5"]),
        ("agent", ["where", "measure"], ["mb gamma=0.9", "mf alpha=0.1"]),
    ],
)
def test_compare(grid, key, head, first):
    run, _ = grid
    code, out, err = tell("compare", run, "--by", key)
    assert code == 0, err
    names, *lines = rows(out)
    assert names[: len(head)] == head
    assert lines[0][len(head) : len(head) + 2] == first
    assert not any(word in out.partition("\n\n")[0].replace("gamma=0", "").replace("alpha=0", "") for word in LONG)


def test_two_runs(grid):
    run, _ = grid
    other, cells = open_lab(run.parent, name="other", seeds=2, models="first", more=VARY)
    reach(other, cells, {path: float(len(path)) + cell.seed for path, cell in cells.items()})
    code, out, err = tell("compare", run, other)
    assert code == 0, err
    assert rows(out)[0][:5] == ["where", "p_A", "alpha", "gamma", "measure"]
    assert not any(word in out.partition("\n\n")[0] for word in LONG)
