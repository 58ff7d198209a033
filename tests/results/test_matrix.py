"""The matrix of trained humans by humans: which visits it plays, where they lie, what is averaged."""

import numpy as np
import pytest

from tests.results.runs_by_hand import VERSIONS, write_cell
from visitlab_cli.config.loading import load_text
from visitlab_cli.console.matrix import text
from visitlab_cli.figures.matrix_picture import save_matrix
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import Evaluation
from visitlab_cli.results.matrix import ADAPTING, FROZEN, MODES, Pairing, matrix_of, plan_matrix
from visitlab_cli.storage.run_folder import open_run

CONFIG = """
name: matrix
seeds: 3
humans: {a: {p_S: [1, 0, 0]}, b: {p_S: [0, 1, 0]}, c: {p_S: [0, 0, 1]}}
agents: {mb: {kind: model_based}}
experiments:
  navigation: {task: navigation, agents: [mb], steps: 20}
  go_to_human: {task: go_to_human, agents: [mb], steps: 20}
  social: {task: social, agents: [mb], humans: [b, a], steps: 20}
  visit:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/mb/a}
    humans: [b]
    trials: 20
  other:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/mb/b}
    humans: [b]
"""


def config(more=""):
    return load_text(CONFIG.replace("    trials: 20", f"    trials: 20{more}"), "matrix.yaml")


@pytest.fixture
def run(tmp_path):
    return open_run(tmp_path, config(), VERSIONS)[0]


def test_every_trained_human_meets_every_human_in_both_modes():
    planned = plan_matrix(config(), "visit")
    assert list(planned) == [Pairing(trained, met, mode) for trained in "ba" for met in "abc" for mode in MODES]
    for pairing, cells in planned.items():
        assert [cell.seed for cell in cells] == [0, 1, 2]
        for cell in cells:
            assert (cell.experiment, cell.human, cell.frozen) == ("visit", pairing.met, pairing.mode == FROZEN)
            assert cell.modules == {
                "navigation": f"navigation/mb/seed-000{cell.seed}",
                "go_to_human": f"go_to_human/mb/seed-000{cell.seed}",
                "social": f"social/mb/{pairing.trained}/seed-000{cell.seed}",
            }
            assert cell.settings.modules.social == f"social/mb/{pairing.trained}"
            assert cell.steps == 2000
    paths = [cell.path for cells in planned.values() for cell in cells]
    assert len(set(paths)) == 2 * 3 * 2 * 3


def test_what_the_config_plays_itself_is_not_played_again():
    own = {cell.path for cell in plan(config())}
    planned = plan_matrix(config(), "visit")
    shared = [pairing for pairing, cells in planned.items() if cells[0].path in own]
    assert shared == [Pairing("a", "b", ADAPTING)]
    elsewhere = [cells[0].path for cells in planned.values() if cells[0].path not in own]
    assert all(path.startswith("evaluations/") for path in elsewhere)
    assert planned[Pairing("a", "c", FROZEN)][0].path == next(
        cell.path for cell in plan(config(), Evaluation(("c",), frozen=True)) if cell.experiment == "visit"
    )


def test_humans_and_trials_of_ones_own():
    planned = plan_matrix(config(), "visit", ["c"], 7)
    assert {pairing.met for pairing in planned} == {"c"}
    assert {cell.steps for cells in planned.values() for cell in cells} == {700}
    whole = plan_matrix(config(), "visit", trials=7)
    assert whole[Pairing("b", "c", FROZEN)][0].path == planned[Pairing("b", "c", FROZEN)][0].path


def test_the_folder_of_an_evaluation_without_another_module_is_as_before():
    assert Evaluation(("c",), 7, frozen=True).folder == "evaluations/5dabd20e/"
    assert Evaluation(("c",), 7, frozen=True, social="social/mb/b").folder != "evaluations/5dabd20e/"


def test_frozen_all_trials_count_and_adapting_the_last_tenth(run):
    planned = plan_matrix(config(), "visit")
    rewards = np.arange(20.0)
    for mode in MODES:
        for cell in planned[Pairing("b", "c", mode)]:
            write_cell(run, cell, rewards + cell.seed)
    goals = matrix_of(run, planned).goals
    frozen, adapting = goals[Pairing("b", "c", FROZEN)], goals[Pairing("b", "c", ADAPTING)]
    assert (frozen.value.mean, adapting.value.mean) == (10.5, 19.5)
    half = 4.302652729911275 / np.sqrt(3)  # Student's t for 2 degrees of freedom; the deviation is 1
    assert frozen.value.half == pytest.approx(half)
    assert adapting.units == (3, 3)
    assert goals[Pairing("a", "a", FROZEN)].value is None


@pytest.mark.parametrize(("models", "n", "mean"), [("first", 1, 1.0), ("crossed", 3, 1.0), ("paired", 3, 1.0)])
def test_visits_of_the_same_modules_are_one_seed(tmp_path, models, n, mean):
    chosen = config(f"\n    models: {models}")
    run, chosen = open_run(tmp_path, chosen, VERSIONS)
    planned = plan_matrix(chosen, "visit")
    for cell in planned[Pairing("b", "a", FROZEN)]:
        write_cell(run, cell, np.full(20, float(cell.seed)))
    found = matrix_of(run, planned).goals[Pairing("b", "a", FROZEN)]
    assert (found.units, found.value.mean) == ((n, 9 if models == "crossed" else 3), mean)


def test_as_json(run):
    planned = plan_matrix(config(), "visit")
    for cell in planned[Pairing("b", "a", FROZEN)][:1]:
        write_cell(run, cell, np.full(20, 2.0))
    told = matrix_of(run, planned).as_json()
    assert (told["trained_with"], told["humans"], told["social"]) == (["b", "a"], ["a", "b", "c"], "social/mb")
    first, second = told["goals"][:2]
    group = planned[Pairing("b", "a", FROZEN)][0].group
    assert first == {
        "trained_with": "b", "human": "a", "mode": "frozen", "mean": 2.0, "interval": None, "n": 1, "n_of": "seeds",
        "cells": group,
    }  # fmt: skip
    assert (second["mean"], second["n"]) == (None, 0)


def test_of_a_visit_with_a_pool_it_is_said_that_each_row_is_one_training(tmp_path):
    pool = CONFIG.replace("social: social/mb/b}", "social: {pool: [social/mb/b, social/mb/a]}}")
    pooled, chosen = open_run(tmp_path / "pool", load_text(pool, "matrix.yaml"), VERSIONS)
    for visit, trainings in (("other", ["social/mb/b", "social/mb/a"]), ("visit", [])):
        planned = plan_matrix(chosen, visit)
        assert {len(cells[0].modules) for cells in planned.values()} == {3}
        matrix = matrix_of(pooled, planned)
        words = "Each row is one training alone; other itself begins with 2 as one."
        assert matrix.as_json()["pool"] == trainings
        assert (words in text(matrix)) == bool(trainings)
        save_matrix(matrix, tmp_path / "matrix.svg")
        assert ("itself begins" in (tmp_path / "matrix.svg").read_text()) == bool(trainings)


ELSEWHERE = CONFIG.replace(
    "  visit:\n", "  more: {task: social, agents: [mb], humans: [c, a], steps: 20}\n  visit:\n", 1
)


def test_each_training_of_a_pool_is_a_row_wherever_it_was_trained(tmp_path):
    pool = ELSEWHERE.replace("social: social/mb/a}", "social: {pool: [social/mb/b, more/mb/c, more/mb/a]}}")
    pooled, chosen = open_run(tmp_path, load_text(pool, "matrix.yaml"), VERSIONS)
    planned = plan_matrix(chosen, "visit")
    matrix = matrix_of(pooled, planned)
    assert matrix.trained == ["b", "social/mb/a", "c", "more/mb/a"]
    for pairing, cells in planned.items():
        training = matrix.trainings[pairing.trained]
        assert training.endswith(pairing.trained)
        assert {(cell.modules["social"], len(cell.modules)) for cell in cells} == {
            (f"{training}/seed-000{seed}", 3) for seed in range(3)
        }
    assert "one training alone; not of social/mb: more/mb/c, more/mb/a; visit itself begins with 3" in text(matrix)


def test_the_picture_says_every_number_and_marks_what_is_missing(run, tmp_path):
    planned = plan_matrix(config(), "visit")
    for number, (pairing, cells) in enumerate(planned.items()):
        if pairing != Pairing("b", "a", FROZEN):
            for cell in cells:
                write_cell(run, cell, np.full(20, number + 0.01 * cell.seed))
    matrix = matrix_of(run, planned)
    target = tmp_path / "figures" / "matrix.svg"
    save_matrix(matrix, target)
    drawn = target.read_text()
    words = {line.partition("<!-- ")[2].partition(" -->")[0] for line in drawn.splitlines() if "<!-- " in line}
    numbers = [f"{goals.value.mean:.2f}" for goals in matrix.goals.values() if goals.value]
    assert len(set(numbers)) == 11
    assert {*numbers, "–", "frozen", "adapting", "trained with", "leads"} <= words
    save_matrix(matrix, target)
    assert target.read_text() == drawn


def test_nothing_played_is_drawn_too(run, tmp_path):
    save_matrix(matrix_of(run, plan_matrix(config(), "visit", ["c"])), tmp_path / "matrix.png")
    assert (tmp_path / "matrix.png").read_bytes().startswith(b"\x89PNG")
