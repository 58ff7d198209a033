"""The table of a run, on cells written by hand."""

import math

import numpy as np
import pytest

from tests.results.runs_by_hand import open_lab, reach, write_cell
from visitlab_cli.results.runs import run_lines
from visitlab_cli.results.summary import steps_to, summaries
from visitlab_cli.results.tables import stacked, trials_of

NAVIGATION = [f"navigation/mb/seed-000{seed}" for seed in range(3)]


def lines_of(run, cells):
    return {line.group.path: line for line in summaries(run, list(cells.values()))}


def test_mean_interval_median_and_seconds(tmp_path):
    run, cells = open_lab(tmp_path)
    for path, value, seconds in zip(NAVIGATION, (1.0, 2.0, 6.0), (1.0, 2.0, 6.0), strict=True):
        write_cell(run, cells[path], [99.0] * 18 + [value - 1, value + 1], seconds)  # the last tenth alone counts
    line = lines_of(run, cells)["navigation/mb"]
    assert (line.value.mean, line.median, line.n, line.done, line.seconds) == (3.0, 2.0, 3, 3, 3.0)
    assert line.value.half == pytest.approx(4.303 * math.sqrt(7.0 / 3), abs=1e-3)
    assert (line.group.experiment, line.group.agent, line.group.human) == ("navigation", "mb", "")


def test_what_is_not_done_is_not_known(tmp_path):
    run, cells = open_lab(tmp_path)
    reach(run, cells, {NAVIGATION[1]: 4.0})
    (run / NAVIGATION[1] / "timing.json").write_text("{")
    lines = lines_of(run, cells)
    assert list(lines) == [
        "navigation/mb",
        "navigation/mf",
        "go_to_human/mb",
        "social/mb/slow",
        "visit/slow",
        "visit/fast",
    ]
    one, none = lines["navigation/mb"].as_json(), lines["visit/fast"].as_json()
    assert (one["mean"], one["interval"], one["n"], one["cells"], one["seconds_a_cell"]) == (4.0, None, 1, 3, None)
    assert (none["mean"], none["n"], none["steps_to_level"], none["human"]) == (None, 0, None, "fast")


def test_crossed_models_are_no_more_seeds_than_were_trained(tmp_path):
    run, cells = open_lab(tmp_path, models="crossed")
    visits = [path for path in cells if path.startswith("visit/fast")]
    assert len(visits) == 9
    reach(run, cells, {path: 10.0 * int(path.split("/model-")[1][:4]) + cells[path].seed for path in visits})
    line = lines_of(run, cells)["visit/fast"]
    assert (line.n, line.done, line.value.mean, line.median) == (3, 9, 11.0, 11.0)


@pytest.mark.parametrize(
    ("rewards", "level", "expected"),
    [
        ([0, 0, 1, 0, 1, 1], 1, 60),  # the first that is there, though it falls again
        ([5, 0, 0, 0, 0, 0], 5, 20),
        ([0, 0, 0, 0, 0, 1], 1, 115),  # the last trial is cut short
        ([0, 0, 0, 0, 0, 1], 1.01, math.inf),
        ([0] * 500 + [1] * 500, 0.5, 510 * 20),  # batches of ten trials
        ([0, 2] * 500, 1, 200),
    ],
)
def test_steps_to_a_level(rewards, level, expected):
    steps = len(rewards) * 20 - 5
    assert steps_to(level, np.array(rewards, dtype=float), 20, steps) == expected


def test_the_median_cell_must_get_there(tmp_path):
    run, cells = open_lab(tmp_path)
    rising = [0.0] * 10 + [3.0] * 10
    for path, rewards in zip(NAVIGATION, (rising, [0.0] * 20, rising), strict=True):
        write_cell(run, cells[path], rewards)
    assert lines_of(run, cells)["navigation/mb"].steps_to_level == 220  # at the end of the 11th trial
    run, cells = open_lab(tmp_path, seed=1)
    for path, rewards in zip(NAVIGATION, (rising, [0.0] * 20, [0.0] * 20), strict=True):
        write_cell(run, cells[path], rewards)
    assert lines_of(run, cells)["navigation/mb"].steps_to_level is None


def test_a_list_of_runs(tmp_path):
    first, cells = open_lab(tmp_path)
    reach(first, cells, {NAVIGATION[0]: 1.0})
    second, cells = open_lab(tmp_path, seed=1, seeds=1)
    reach(second, cells, dict.fromkeys(cells, 1.0))
    damaged, _ = open_lab(tmp_path, seed=2)
    (damaged / "config.yaml").write_text("name: [")
    lines = {line.run: line for line in run_lines(tmp_path)}
    assert {run: line.state for run, line in lines.items()} == {first: "incomplete", second: "done", damaged: "damaged"}
    assert (lines[first].done, lines[first].cells, lines[first].seeds) == (1, 18, 3)
    assert lines[first].size == sum(file.stat().st_size for file in first.rglob("*") if file.is_file())
    assert (lines[damaged].cells, "config.yaml" in lines[damaged].problem) == (None, True)
    assert [line.changed for line in run_lines(tmp_path)] == sorted(line.changed for line in lines.values())[::-1]


def test_the_cells_tables_one_below_the_other(tmp_path):
    vary = "vary: {agents.mf.alpha: [0.5, 1], experiments.visit.social_reward: [social, none]}\n"
    run, cells = open_lab(tmp_path, seeds=2, models="crossed", more=vary)
    chosen = [cell for path, cell in cells.items() if path.startswith(("navigation/", "visit/fast"))]
    for number, cell in enumerate(chosen):
        write_cell(run, cell, [number, number])
    rows = stacked(run, chosen, trials_of).to_pylist()
    assert len(rows) == 2 * len(chosen)
    for number, cell in enumerate(chosen):
        row = rows[2 * number + 1]
        visit = cell.experiment == "visit"
        assert (row["experiment"], row["agent"], row["human"]) == (cell.experiment, cell.agent, cell.human or None)
        assert (row["trial"], row["reward"], row["goals"], row["seed"]) == (
            1,
            number,
            number if visit else None,
            cell.seed,
        )
        assert row["agents.mf.alpha"] == (None if cell.agent == "mb" and not visit else cell.config.agents["mf"].alpha)
        assert row["experiments.visit.social_reward"] == (cell.settings.social_reward if visit else None)
        assert row["model_seed"] == (int(cell.modules["social"][-1]) if visit else None)
