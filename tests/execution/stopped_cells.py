"""Cells that are stopped between blocks and gone on with, beside the same ones undisturbed.

`python -m tests.execution.stopped_cells` plays those of `CONFIG` and prints what differs: every task, kind of agent,
controller and belief, which is quick only while nothing is compiled.
"""

import hashlib
import os
import random
import sys
from pathlib import Path

from visitlab_cli.agents import multi_model
from visitlab_cli.config.loading import load
from visitlab_cli.errors import Interrupted
from visitlab_cli.execution import cell_runner, checkpoints
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.cell_folder import CELL, TIMING, read_cell
from visitlab_cli.storage.leftovers import remove_leftovers

CONFIG = """
name: stopped
seed: 4
humans:
  fast: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.1, p_P: 0.3}
  slow: {p_S: [1, 0, 0], p_M: 0.1, p_O: 0.1, p_A: 0.05, p_P: 0.5}
labs:
  four: {rooms: 2 x 2, size: 2 x 2, walls: between, doorway: 1}
  shut: {like: four, closed: [CD]}
agents:
  q_learning: {kind: q_learning}
  mirrored: {kind: q_learning, symmetric: true}
  model_based: {kind: model_based, plan_every: 200, unvisited: zero, prior_strength: 20}
  exploring: {kind: model_based, plan_every: 200, exploration: count_bonus, bonus: 0.1}
  rmax: {kind: rmax, plan_every: 200}
  watching: {kind: observer, watches: coordinated, learner: q_learning, until: 150, acts_as: q_learning}
  last_seen: {kind: last_seen, plan_every: 50}
  scripted: {kind: scripted}
  random: {kind: random}
  windowed: {kind: windowed, plan_every: 200, k: 2}
  forgetting: {kind: forgetting, plan_every: 200, k: 3}
  coordinated: {kind: coordinated, plan_every: 200}
  prioritized_sweeping: {kind: prioritized_sweeping, backups: 2, theta: 0.000001}
  dyna: {kind: dyna, backups: 3}
  sampling: {kind: dyna, backups: 3, updates: sampled}
  multi_model: {kind: multi_model, plan_every: 200}
experiments:
  navigation:
    task: navigation
    lab: four
    agents: [q_learning, model_based, rmax, watching, last_seen, windowed, prioritized_sweeping, sampling]
    phases: [{trials: 6}, {trials: 6, lab: shut, plan_every: 30}, {trials: 6, doors: {AB: 0.5}}]
  go_to_human: {task: go_to_human, agents: [q_learning, rmax, forgetting, dyna], steps: 300}
  social:
    task: social
    agents: [AGENTS]
    phases: [{trials: 8, human: fast}, {trials: 8, human: slow}]
  social_of_one: {task: social, agents: [multi_model, model_based], humans: [fast], steps: 300}
  hidden:
    task: social
    agents: [q_learning]
    observe: geometry
    belief: {parameters: em}
    phases: [{trials: 12, human: fast}, {trials: 8, human: slow}]
  PHASED_VISITS
""".replace(
    "AGENTS",
    "q_learning, mirrored, model_based, exploring, rmax, watching, scripted, random, windowed, forgetting, "
    "coordinated, prioritized_sweeping, dyna, multi_model",
)
VISIT = """
  visit_NAME:
    task: visit
    lab: four
    trial_steps: 20
    modules: {navigation: navigation/rmax, go_to_human: go_to_human/rmax, social: SOCIAL}
    phases: [{trials: 6, human: fast}, {trials: 6, human: slow, lab: shut}, {trials: 6, human: fast, doors: {AB: 0.5}}]
"""
VISITS = {
    "by_model": ("social/model_based/phases", "controller: [route, mask]"),
    "by_queue": ("social/prioritized_sweeping/phases", "controller: [plan]"),
    "by_window": ("social/windowed/phases", ""),
    "by_several": ("social_of_one/multi_model/fast", ""),
    "leading": (
        "social/scripted/phases",
        "controller: lead\n    learns: [social, navigation]\n    navigation_model: own",
    ),
    "hidden": (
        "hidden/q_learning/phases",
        "observe: geometry\n    belief: {parameters: em}\n    controller: lead\n    learns: [social, navigation]",
    ),
}


def config_text():
    visits = [
        VISIT.strip("\n").replace("NAME", name).replace("SOCIAL", social) + f"\n    {more}"
        for name, (social, more) in VISITS.items()
    ]
    return CONFIG.replace("  PHASED_VISITS", "\n".join(visits))


def stopping_after(steps):
    """A report that asks for the end from so many steps on."""

    def report(done):
        if done >= steps:
            raise Interrupted("stopped")

    return report


def went(run, cell, report=lambda steps: None):
    """Do a cell as the runner does: the step from which it went on, 0 for the beginning; None where it was stopped."""
    begun = [0]
    remove_leftovers(run)
    try:
        cell_runner.run_cell(run, cell, report, begun.append)
    except Interrupted:
        return None
    remove_leftovers(run)
    return begun[-1]


def digests(run, cell):
    """The sha256 of a cell's files, by their names; `cell.json` says the same of those that it lists."""
    found = {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted((run / cell.path).iterdir())
        if file.name != TIMING
    }
    told = read_cell(run / cell.path)["files"]
    assert found.keys() - told.keys() == {CELL}
    assert all(found[name] == each["sha256"] for name, each in told.items())
    return found


def often(rows):
    """Play in blocks of so many rows, with a checkpoint after each."""
    cell_runner.BLOCK_ROWS = rows
    checkpoints.EVERY, checkpoints.SHARE = 0.0, float("inf")


def main(folder):
    file = folder / "stopped.yaml"
    file.write_text(config_text())
    cells, draw = plan(load(file)), random.Random(7)
    whole, stopped = folder / "whole", folder / "stopped"
    often(47)
    os.fsync = lambda descriptor: None  # most of the time, otherwise
    multi_model.GIVEN_UP = -0.5  # so that it looks into its journal
    for cell in cells:
        went(whole, cell)
        for stop in sorted(draw.sample(range(1, cell.steps - 60), 2)):
            if went(stopped, cell, stopping_after(stop)) is not None:
                print(f"{cell.path}: was not stopped after {stop} steps")
        begun = went(stopped, cell)
        if not 0 < (begun or 0) < cell.steps:
            print(f"{cell.path}: went on from step {begun}")
        if digests(whole, cell) != digests(stopped, cell):
            print(f"{cell.path}: other bytes")
    if left := list(stopped.glob(".tmp-*")):
        print(f"left behind: {left}")
    print(f"{len(cells)} cells")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
