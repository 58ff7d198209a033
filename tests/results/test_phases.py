"""What came of each phase, of rewards written by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from tests.results.runs_by_hand import open_lab
from visitlab_cli.config.names import changes_of_place
from visitlab_cli.console.options import FIRST_TRIALS
from visitlab_cli.execution.cell_runner import facts_of
from visitlab_cli.results import phases
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.results.phases import PhaseResult, phase_results
from visitlab_cli.results.units import Units
from visitlab_cli.storage.arrays import write_trials
from visitlab_cli.storage.cell_folder import TRIALS, NewCell

IN_TURN = """
  swap:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    phases: [{trials: 6, human: slow}, {trials: 4, human: fast}, {trials: 2, human: slow}]
"""
REWARDS = [[1, 2, 3, 4, 5, 6, 0, 0, 1, 1, 4, 5], [3, 4, 5, 6, 7, 8, 1, 1, 2, 2, 4, 5]]


@pytest.fixture
def found(tmp_path):
    run, cells = open_lab(tmp_path, seeds=2, more=IN_TURN)
    for seed, rewards in enumerate(REWARDS):
        cell = cells[f"swap/phases/seed-{seed:04d}"]
        with NewCell(run, cell.path) as new:
            rewards = np.array(rewards, float)
            write_trials(new.folder / TRIALS, rewards, with_goals=True, phase_trials=(6, 4, 2))
            new.commit(facts_of(cell, rewards), {"seconds": 1.0})
    return phase_results(run, list(cells.values()), first=2)


def test_first_trials_rest_change_and_return(found):
    assert [(each.phase, each.human, each.begins, each.trials) for each in found] == [
        (0, "slow", 0, 6),
        (1, "fast", 6, 4),
        (2, "slow", 10, 2),
    ]
    assert [each.first.mean for each in found] == [2.5, 0.5, 4.5]
    assert [each.rest.mean if each.rest else None for each in found] == [5.5, 1.5, None]
    assert [each.change.mean if each.change else None for each in found] == [None, 0.5 - 5.5, 4.5 - 1.5]
    assert [each.met_before for each in found] == [None, None, 0]
    assert [each.again.mean if each.again else None for each in found] == [None, None, 4.5 - 2.5]
    assert {each.units.n for each in found} == {2}


def test_a_phase_says_what_is_new_of_its_lab_and_doors(tmp_path):
    from visitlab_cli.console.phases import table_and_notes
    from visitlab_cli.figures.phases_figure import _labels
    from visitlab_cli.report.curves import _phases

    labs = "labs: {rooms: {rooms: 2 x 2, walls: between}, shut: {like: rooms, closed: [AB]}}"
    more = IN_TURN.replace("task: visit", "task: visit\n    lab: rooms").replace("navigation/mf", "walled/mf")
    more = more.replace("{trials: 4, human: fast}", "{trials: 4, human: slow, lab: shut}")
    more = more.replace("{trials: 2, human: slow}", "{trials: 2, human: slow, doors: {CD: 0.1, AB: 0.25}}")
    walled = "  walled: {task: navigation, lab: rooms, agents: [mf], steps: 400}"
    _, cells = open_lab(tmp_path, more=f"{walled}{more}{labs}\n")
    settings = cells["swap/phases/seed-0000"].settings
    new = ["", "lab shut", "lab rooms, doors AB 0.25, CD 0.1"]
    assert settings.changes_of_place == new
    assert changes_of_place("a", [("a", {"AB": 1.0}), ("a", {})]) == ["doors AB 1", "no door toggles"]
    assert changes_of_place("a", [("b", {}), ("b", {})]) == ["lab b", ""]
    assert [name for _, name in _phases(settings)] == ["0: slow", *(f"{at}: slow, {new[at]}" for at in (1, 2))]
    assert _labels(1, settings.phases[1], new[1])[0] == "phase 1: slow, lab shut"
    found = [
        PhaseResult(None, at, "slow", place, 0, 1, mean_of([1.0]), None, None, None, None, Units(1, 1))
        for at, place in enumerate(new)
    ]
    group = SimpleNamespace(experiment="swap", agent="mb", point=(), measure="")
    head, first, second, *_ = table_and_notes([each._replace(group=group) for each in found], 2)[0].splitlines()
    assert "new place" in head
    assert (first.split()[4], second.split()[4:6]) == ("-", ["lab", "shut"])
    assert found[1]._replace(group=group).as_json()["place"] == "lab shut"


def test_phases_in_one_place_are_told_as_before(found):
    from visitlab_cli.console.phases import table_and_notes

    assert "place" not in found[1].as_json()
    assert table_and_notes(found, 2)[0].split()[:6] == ["experiment", "agent", "phase", "human", "trials", "first"]


def test_differences_are_of_the_same_robots(found):
    assert found[1].change.half == pytest.approx(0.5 * 12.706 / 2 * 2, rel=1e-3)  # of -4.5 and -5.5
    assert found[2].again.half == pytest.approx(1.0 * 12.706, rel=1e-3)  # of 3 and 1


def test_no_batch_of_the_figure_lies_in_two_phases(tmp_path):
    from visitlab_cli.figures.phases_figure import edges_of
    from visitlab_cli.report.curves import batch_edges

    _, cells = open_lab(tmp_path, more=IN_TURN.replace("trials: 6", "trials: 600").replace("trials: 4", "trials: 37"))
    settings = cells["swap/phases/seed-0000"].settings
    assert {0, 600, 637, 639} <= set(edges_of(settings).tolist())
    assert (np.diff(edges_of(settings)) > 0).all()
    assert {200, 500} <= set(batch_edges(700, 100, 100).tolist())


def test_the_row_of_a_data_frame_is_flat(found):
    row = found[2].as_row()
    assert (row["phase"], row["human"], row["again"], row["rest"], row["rest_low"]) == (2, "slow", 2.0, None, None)
    assert row["again_low"] < row["again"] < row["again_high"]


def test_the_commands_and_python_mean_the_same_first_trials():
    assert FIRST_TRIALS == phases.FIRST
