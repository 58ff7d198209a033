"""A social training that starts from another's model: its place in the plan, and what it goes on from."""

import shutil

import numpy as np
import pytest

from tests.program import TINY, hashes, only_cells, the_run, visitlab
from visitlab_cli.config.loading import load, load_text
from visitlab_cli.errors import RunError
from visitlab_cli.execution.build import build
from visitlab_cli.execution.warm_up import _pair
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.storage.cell_folder import MODEL

CONFIG = """
name: on
seeds: 2
humans:
  slow: {p_S: [1, 0, 0]}
  fast: {p_S: [0, 0, 1]}
agents:
  mf: {kind: q_learning}
  mb: {kind: model_based, plan_every: 200}
  rmax: {kind: rmax, plan_every: 200}
  watcher: {kind: observer, watches: mb, learner: mf, until: 200, acts_as: mf}
experiments:
  third: {task: social, agents: [mb], humans: [slow], steps: 400, start_from: second/mb/fast}
  second: {task: social, agents: [mb], humans: [fast], steps: 400, start_from: first/mb/slow}
  first: {task: social, agents: [mb, mf, rmax, watcher], humans: [slow], steps: 400}
  mf_on: {task: social, agents: [mf], humans: [fast], steps: 400, start_from: first/mf/slow}
  rmax_on: {task: social, agents: [rmax], humans: [fast], steps: 400, start_from: first/rmax/slow}
  watcher_on: {task: social, agents: [watcher], humans: [fast], steps: 400, start_from: first/watcher/slow}
"""
STARTS = {"second/mb/fast": "first/mb/slow", "third/mb/slow": "second/mb/fast", "mf_on/mf/fast": "first/mf/slow"}
STARTS |= {"rmax_on/rmax/fast": "first/rmax/slow", "watcher_on/watcher/fast": "first/watcher/slow"}
LONG = 300


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    file = tmp_path_factory.mktemp("config") / "on.yaml"
    file.write_text(CONFIG)
    return file


@pytest.fixture(scope="module")
def run(config, tmp_path_factory):
    out = tmp_path_factory.mktemp("runs")
    done = visitlab("train", config, "--out", out, "--workers", 2)
    assert done.returncode == 0, done.stderr
    return the_run(out)


def planned(more="", of=CONFIG):
    return {cell.path: cell for cell in plan(load_text(of + more, "on.yaml"))}


def test_each_seed_starts_from_the_same_seed_which_is_planned_first():
    cells = planned()
    for group, start in STARTS.items():
        for seed in ("seed-0000", "seed-0001"):
            assert cells[f"{group}/{seed}"].modules == {"social": f"{start}/{seed}"}
    assert not any(cell.modules for cell in cells.values() if cell.experiment == "first")
    order = list(cells)
    assert all(order.index(needed) < order.index(path) for path in cells for needed in cells[path].modules.values())


def test_a_config_without_it_is_planned_as_before():
    tiny = load(TINY)
    trainings = [cell for cell in plan(tiny) if cell.task != "visit"]
    assert [cell.experiment for cell in trainings] == sorted(
        [cell.experiment for cell in trainings], key=list(tiny.experiments).index
    )
    assert not any(cell.modules for cell in trainings)


def test_a_grid_over_what_it_starts_from_reaches_it():
    cells = planned("vary: {humans.fast.p_A: [0.1, 0.2]}\n")
    label = "humans.fast.p_A=0.2"
    assert cells[f"third/mb/slow/{label}/seed-0001"].modules == {"social": f"second/mb/fast/{label}/seed-0001"}
    assert cells[f"second/mb/fast/{label}/seed-0001"].modules == {"social": "first/mb/slow/seed-0001"}
    assert "first/mb/slow/seed-0001" in cells


def test_a_long_chain_is_planned_in_order():
    link = "  s{}: {{task: social, agents: [mb], humans: [slow], steps: 20, start_from: s{}/mb/slow}}\n"
    last = "  s0: {task: social, agents: [mb], humans: [slow], steps: 20}\n"
    chain = "".join(link.format(n, n - 1) for n in range(LONG, 0, -1)) + last
    cells = planned(of=CONFIG.split("  third:")[0] + chain)
    assert list(cells)[::2] == [f"s{n}/mb/slow/seed-0000" for n in range(LONG + 1)]


@pytest.mark.parametrize("agent", ["mb", "rmax"])
def test_what_was_counted_before_is_kept(run, agent):
    before = read_model(run / f"first/{agent}/slow/seed-0001" / MODEL)
    group = {"mb": "second/mb/fast", "rmax": "rmax_on/rmax/fast"}[agent]
    after = read_model(run / group / "seed-0001" / MODEL)
    assert (after["visits"] >= before["visits"]).all()
    assert after["visits"].sum() > before["visits"].sum()
    assert (after["reward_sums"] >= before["reward_sums"]).all()


@pytest.mark.parametrize(("group", "visits"), {"third/mb/slow": 1200, "mf_on/mf/fast": 800}.items())
def test_every_step_of_the_chain_is_in_the_model(run, group, visits):
    assert read_model(run / group / "seed-0000" / MODEL)["visits"].sum() == visits


def test_before_its_first_step_the_agent_is_the_one_that_was_saved(run):
    cells = planned()
    for group, start in STARTS.items():
        saved = read_model(run / start / "seed-0000" / MODEL)
        simulation = build(cells[f"{group}/seed-0000"], {"social": saved})
        again = simulation.parameters.save(simulation.agent)
        assert set(again) == set(saved) - {"random_state"}
        for name, array in again.items():
            np.testing.assert_array_equal(array, saved[name])


def test_an_observer_goes_on_alone_and_is_compiled_by_itself():
    cells = planned()
    first, on = cells["first/watcher/slow/seed-0000"], cells["watcher_on/watcher/fast/seed-0000"]
    assert _pair(first) != _pair(on)


def test_a_model_of_another_shape_is_refused():
    cell = planned()["second/mb/fast/seed-0000"]
    with pytest.raises(RunError, match="has a table of"):
        build(cell, {"social": {"q": np.zeros((2, 3))}})


def test_the_same_bytes_whatever_the_workers_and_the_other_seeds(config, run, tmp_path):
    done = visitlab("train", config, "seeds=1", "--out", tmp_path, "--workers", 1)
    assert done.returncode == 0, done.stderr
    alone, whole = only_cells(hashes(the_run(tmp_path))), only_cells(hashes(run))
    assert alone == {path: digest for path, digest in whole.items() if "seed-0000" in path}


def test_nothing_goes_on_from_what_failed(config, run, tmp_path):
    copy = tmp_path / run.name
    shutil.copytree(run, copy)
    model = copy / "first/mb/slow/seed-0000" / MODEL
    model.write_bytes(bytes(model.stat().st_size))
    for group in ("second/mb/fast", "third/mb/slow"):
        (copy / group / "seed-0000" / "cell.json").unlink()
    failed = visitlab("train", config, "--out", tmp_path, "--workers", 1)
    assert failed.returncode == 4
    assert "second/mb/fast/seed-0000" in failed.stderr
    assert "needs second/mb/fast/seed-0000, which failed" in failed.stderr
    assert not (copy / "third/mb/slow/seed-0000/cell.json").exists()
