"""The best recorded trial of each visit, as plain values that the page plays."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from visitlab_cli.analysis.summary_groups import Group
from visitlab_cli.execution.cells import Cell
from visitlab_cli.recording.reader import check_values, read_trial
from visitlab_cli.report.names import BETWEEN, settings_of, short_paths
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import STEPS, TRIALS, read_cell
from visitlab_cli.story import GESTURES, Steps, captions, executed, moments
from visitlab_cli.world.enums import Action
from visitlab_cli.world.tasks import VISIT

MOST_TRIALS = 12
"""A page plays the best trials of so many visits at most, in the order of the config."""
MOST_STEPS = 1_000
"""A page plays so many steps of a trial at most."""
COLUMNS = (
    "robot_row",
    "robot_col",
    "robot_heading",
    "human_row",
    "human_col",
    "human_heading",
    "interaction_level",
    "distance",
    "desired_direction",
    "goal_room",
    "reward",
)


def best_trials(run: Path, groups: Sequence[Group]) -> list[dict[str, Any]]:
    """The best recorded trial of each visit of a run; empty where none was recorded.

    Raises:
        RunError: a log or a table of trials is damaged.
    """
    found: list[dict[str, Any]] = []
    short = short_paths(groups)
    for group in groups:
        if len(found) < MOST_TRIALS and group.cells[0].task == VISIT:
            found += _best_of(run, group, short)
    return found


def _best_of(run: Path, group: Group, short: Mapping[str, str]) -> list[dict[str, Any]]:
    """The earliest trial with the highest reward among the recorded ones of a group's finished cells."""
    best: tuple[float, int, Cell] | None = None
    for cell in group.cells:
        one_in = cell.config.record.one_trial_in
        if not one_in or read_cell(run / cell.path) is None:
            continue
        rewards = read_trials(run / cell.path / TRIALS)["reward"][::one_in]
        place = int(np.argmax(rewards))
        if best is None or rewards[place] > best[0]:
            best = float(rewards[place]), place * one_in, cell
    if best is None:
        return []
    reward, number, cell = best
    name = BETWEEN.join((f"{group.experiment}/{group.human}", *settings_of(group, short)))
    log = run / cell.path / STEPS
    steps = read_trial(log, number)
    check_values(log, steps)
    return [_plain(name, cell, number, reward, steps)]


def _plain(name: str, cell: Cell, number: int, reward: float, whole: Steps) -> dict[str, Any]:
    steps = {name: values[: MOST_STEPS + 1] for name, values in whole.items()}
    said = [GESTURES.get(Action(int(action)), "") for action in executed(steps)]
    return {
        "group": name,
        "cell": cell.path,
        "trial": number,
        "goals": reward,
        "steps": len(whole["step"]) - 1,
        "columns": {name: steps[name].astype(int).tolist() for name in COLUMNS},
        "said": {str(step): word for step, word in enumerate(said) if word},
        "captions": captions(steps),
        "moments": [list(moment) for moment in moments(steps)],
    }
