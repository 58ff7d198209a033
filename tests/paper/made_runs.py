"""Run folders whose trials are made up: rewards of known mean and deviation in real cells."""

import numpy as np

from visitlab_cli.config.loading import load_text
from visitlab_cli.execution.cell_runner import facts_of
from visitlab_cli.paper.published.counterparts import COUNTERPARTS
from visitlab_cli.paper.published.curves import published_curves
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.arrays import write_trials
from visitlab_cli.storage.cell_folder import TRIALS, NewCell
from visitlab_cli.storage.run_folder import open_run

CONFIG = """
name: {name}
seeds: {seeds}
humans:
  human_1: {{p_S: [1, 0, 0], p_H: 0, p_M: 0.1, p_O: 0.1, p_A: 0, p_P: 0}}
  human_2: {{p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05, p_P: 0}}
agents:
  rmax: {{kind: rmax, gamma: 0.9, r_max: 1, plan_every: 1000}}
  mb: {{kind: model_based, gamma: 0.9, epsilon: 0.05, plan_every: 1000, unvisited: uniform}}
  chance: {{kind: random}}
experiments:
  navigation: {{task: navigation, agents: [rmax, chance], steps: {navigation_steps}}}
  go_to_human: {{task: go_to_human, agents: [mb], steps: 200000}}
  social_humans: {{task: social, agents: [mb], humans: [human_2], steps: {training}}}
  visit:
    task: visit
    modules: {{navigation: navigation/rmax, go_to_human: go_to_human/mb, social: social_humans/mb/human_2}}
    humans: [human_1]
    models: {models}
    planner_rewards: {planner}
"""
DEFAULTS = {
    "name": "made",
    "seeds": 10,
    "navigation_steps": 500_000,
    "training": 500_000,
    "models": "paired",
    "planner": "carried",
}
PUBLISHED = {(curve.figure, curve.condition): curve for curve in published_curves()}


def make_run(out, shifts, noise=0.1, **options):
    """A run whose curves are the published ones plus the shift of their group, and noise of each set of modules."""
    config = load_text(CONFIG.format(**(DEFAULTS | options)), "made.yaml")
    run, config = open_run(out, config, {})
    random, offsets = np.random.default_rng(0), {}
    for cell in plan(config):
        if cell.group not in shifts:
            continue
        (published,) = [PUBLISHED[key] for key, group in COUNTERPARTS.items() if group == cell.group]
        offset = offsets.setdefault("/".join(cell.modules.values()) or cell.path, random.normal(0, noise))
        rewards = np.repeat(published.mean, published.trials_in_batch) + shifts[cell.group] + offset
        with NewCell(run, cell.path) as new:
            write_trials(new.folder / TRIALS, rewards, with_goals=cell.task == "visit")
            new.commit(facts_of(cell, rewards), {})
    return run
