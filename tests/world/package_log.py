"""A log of the package's own making, for the oracle: played by a script that explores a lot, without training.

Run as a program it plays the package that comes first on the path: `python package_log.py TASK STEPS OUT.npz LAB ...`,
a phase of so many steps in each lab; "" is the paper's.
"""

import sys
from pathlib import Path

import numpy as np

from visitlab_cli.world.enums import Action, InteractionLevel

HUMAN = {"p_S": (0.2, 0.3, 0.5), "p_H": 0.3, "p_M": 0.2, "p_O": 0.15, "p_A": 0.1, "p_P": 0.4}
EPSILON = 0.3
TRIAL_STEPS = {"navigation": 20, "go_to_human": 20, "social": 20, "visit": 100}

TESTS = Path(__file__).parents[1]
NINE_ROOMS = (TESTS / "oracle/nine_rooms.txt").read_text().strip()
CORRIDOR = (TESTS.parent / "configs/beyond/labs/corridor.txt").read_text().strip()
SMALL = """\
AAabBbeEE
AAABBBEEE
AaABbBEeE
CcCDdDFfF
CCCDDdfFF
CCcdD#FFF
GGG######"""
"""Six rooms in two rings, a solid cell, and a room that no way leads to."""
LABS = {
    "nine rooms": {"map": NINE_ROOMS},
    "corridor": {"map": CORRIDOR, "corridor": "Z"},
    "closed": {"map": NINE_ROOMS, "closed": ["AB", "AD", "BE"]},  # A is shut off
    "toggling": {"map": NINE_ROOMS, "closed": ["DE", "EH"], "toggling": {"BE": 0.3, "DE": 0.1, "EF": 1.0, "EH": 0.0}},
    "small": {"map": SMALL, "toggling": {"AB": 0.5, "BE": 0.25, "EF": 0.5}},  # E may be shut off
}


def make_lab(name):
    """One of `LABS` for the package's kernels; None for the paper's."""
    from visitlab_cli.world.layout import Layout

    about = LABS.get(name, {})
    if not about:
        return None
    return Layout(about["map"]).lab(about.get("corridor", ""), about.get("closed", ()), about.get("toggling"))


def module_tables(states=5184):
    """Q of navigation and go_to_human with many exact ties, shapes (states, 25) and (320, 25)."""
    draw = np.random.default_rng(1)
    return draw.integers(0, 3, (states, 25)).astype(float), draw.integers(0, 3, (320, 25)).astype(float)


def make_task(task, distances=(1, 2, 4, 5), goal_rooms=None, lab=None, **options):
    from visitlab_cli.humans.six_parameters import SixParameters
    from visitlab_cli.simulation.visit import make_visit
    from visitlab_cli.world.go_to_human import make_go_to_human
    from visitlab_cli.world.navigation import make_navigation
    from visitlab_cli.world.social import make_social
    from visitlab_cli.world.visit import make_visit_world

    human = SixParameters(**HUMAN).create()
    if task == "navigation":
        return make_navigation(TRIAL_STEPS[task], lab)
    if task == "go_to_human":
        return make_go_to_human(TRIAL_STEPS[task], distances=distances, lab=lab, **options)
    if task == "social":
        return make_social(human, TRIAL_STEPS[task], distances=distances, **options)
    world = make_visit_world(human, goal_rooms, distances, lab)
    tables = module_tables(world.lab.n_rooms * world.lab.rows * world.lab.cols)
    return make_visit(world, *tables, TRIAL_STEPS[task], **options)


def make_agent(task, lab=None):
    """Epsilon-greedy on a fixed table: the script where there is a human to win, else nothing but ties.

    A follower is also looked at and greeted again, as the script would not.
    """
    from visitlab_cli.agents.base import Setting
    from visitlab_cli.agents.q_learning import QLearning
    from visitlab_cli.agents.scripted import ScriptedParameters
    from visitlab_cli.world.lab import paper_lab
    from visitlab_cli.world.tasks import TASKS

    size = TASKS[task].size(lab or paper_lab())
    q = np.zeros(size)
    if task in ("social", "visit"):
        q = ScriptedParameters(kind="scripted").create(Setting(task, *size, 1)).q
        follows = np.arange(len(q)) % len(InteractionLevel) == InteractionLevel.FOLLOWS
        q[np.ix_(follows, [Action.LOOK, Action.HELLO])] = 1
    return QLearning(q, np.zeros(size, np.int32), 0.9, EPSILON, 0.0)


def package_log(task, steps, seed=0, lab="", **options):
    """The columns of a log by name; `lab` is one of `LABS`, the other `options` are as `make_task` takes them."""
    return phases_log(task, [(steps, lab)], seed, **options)


def phases_log(task, phases, seed=0, **options):
    """The same of phases one after the other, each so many steps in a lab."""
    from visitlab_cli.random_numbers import random_state
    from visitlab_cli.simulation.loop import START, play
    from visitlab_cli.world.columns import empty_columns
    from visitlab_cli.world.lab import ALL_OPEN, open_at_first
    from visitlab_cli.world.tasks import columns_of

    labs = [make_lab(name) for _, name in phases]
    agent, random = make_agent(task, labs[0]), random_state(seed, task)
    trial_rewards = np.zeros(sum(steps for steps, _ in phases) // TRIAL_STEPS[task])
    cursor, blocks = START, []
    for number, ((steps, _), lab) in enumerate(zip(phases, labs, strict=True)):
        columns = empty_columns(steps + steps // TRIAL_STEPS[task])
        columns.phase[:] = number
        begin = open_at_first(lab) if lab else ALL_OPEN
        cursor = cursor._replace(scene=cursor.scene._replace(open_doors=begin))
        until = cursor.steps + steps
        record = make_task(task, lab=lab, **options)
        cursor, rows = play(record, agent, cursor, until, random, columns, trial_rewards)
        assert (cursor.steps, rows) == (until, len(columns.step))
        blocks.append(columns)
    names = [column.name for column in columns_of(task)]
    names += ["phase"] if len(phases) > 1 else []
    names += ["open_doors"] if any("toggling" in LABS.get(name, {}) for _, name in phases) else []
    return {name: np.concatenate([getattr(block, name) for block in blocks]) for name in names}


if __name__ == "__main__":
    np.savez(sys.argv[3], **phases_log(sys.argv[1], [(int(sys.argv[2]), lab) for lab in sys.argv[4:]]))
