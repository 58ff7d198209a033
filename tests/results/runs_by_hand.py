"""Runs whose cells are written by hand: a config, and the rewards of every cell's trials."""

import numpy as np

from visitlab_cli.config.loading import load
from visitlab_cli.execution.cell_runner import last_mean
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.saved import declared
from visitlab_cli.storage.arrays import write_model, write_trials
from visitlab_cli.storage.cell_folder import MODEL, TRIALS, NewCell
from visitlab_cli.storage.run_folder import open_run
from visitlab_cli.world.tasks import VISIT

LAB = """
name: {name}
seed: {seed}
seeds: {seeds}
humans:
  slow: {{p_S: [1, 0, 0]}}
  fast: {{p_S: [0, 0, 1]}}
agents:
  mb: {{kind: model_based}}
  mf: {{kind: q_learning}}
experiments:
  navigation: {{task: navigation, agents: [mb, mf], steps: 400}}
  go_to_human: {{task: go_to_human, agents: [mb], steps: 400}}
  social: {{task: social, agents: [{agents_of_social}], humans: [slow], steps: 400}}
  visit:
    task: visit
    modules: {{navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}}
    humans: [slow, fast]
    trials: 20
    trial_steps: 10
    models: {models}
"""
VERSIONS = {"visitlab": "0", "python": "3"}


def open_lab(out, *, name="lab", seed=0, seeds=3, models="paired", agents_of_social="mb", more=""):
    """A run folder below `out` without cells, and its plan by path."""
    file = out / "lab.yaml"
    out.mkdir(parents=True, exist_ok=True)
    filled = LAB.format(name=name, seed=seed, seeds=seeds, models=models, agents_of_social=agents_of_social)
    file.write_text(filled + more)
    run, config = open_run(out, load(file), VERSIONS)
    return run, {cell.path: cell for cell in plan(config)}


def untrained(cell):
    """The arrays of an agent that has seen nothing, as its kind declares them."""
    shapes = {name: ([size or 0 for size in each.shape], each.dtype) for name, each in declared(cell).items()}
    return {name: np.zeros(*shape) for name, shape in shapes.items()} | {"random_state": np.ones(4, np.uint64)}


def write_cell(run, cell, rewards, seconds=2.0):
    """Commit a cell whose trials had these rewards."""
    rewards = np.asarray(rewards, dtype=float)
    facts = {
        "cell": cell.path,
        "seed": cell.seed,
        "steps": cell.steps,
        "trials": len(rewards),
        "mean_reward_last_hundredth": last_mean(rewards, 100),
        "mean_reward_last_tenth": last_mean(rewards, 10),
        "config_hash": cell.run_hash,
        "versions": VERSIONS,
    }
    with NewCell(run, cell.path) as new:
        write_trials(new.folder / TRIALS, rewards, cell.task == VISIT, cell.settings.phase_trials)
        write_model(new.folder / MODEL, untrained(cell))
        new.commit(facts, {"seconds": seconds})


def reach(run, cells, values):
    """Commit cells whose every trial has the reward that `values` gives their path; return their plan's cells."""
    for path, value in values.items():
        write_cell(run, cells[path], np.full(cells[path].trials, value))
    return list(cells.values())
