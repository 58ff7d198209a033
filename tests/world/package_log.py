"""A log of the package's own making, for the oracle: played by a script that explores a lot, without training.

Run as a program it plays the package that comes first on the path: `python package_log.py TASK STEPS OUT.npz`.
"""

import sys

import numpy as np

from visitlab_cli.world.enums import Action, InteractionLevel

HUMAN = {"p_S": (0.2, 0.3, 0.5), "p_H": 0.3, "p_M": 0.2, "p_O": 0.15, "p_A": 0.1, "p_P": 0.4}
EPSILON = 0.3
TRIAL_STEPS = {"navigation": 20, "go_to_human": 20, "social": 20, "visit": 100}


def module_tables():
    """Q of navigation and go_to_human with many exact ties, shapes (5184, 25) and (320, 25)."""
    draw = np.random.default_rng(1)
    return draw.integers(0, 3, (5184, 25)).astype(float), draw.integers(0, 3, (320, 25)).astype(float)


def make_task(task, distances=(1, 2, 4, 5), goal_rooms=tuple(range(9)), **options):
    from visitlab_cli.humans.six_parameters import SixParameters
    from visitlab_cli.simulation.visit import make_visit
    from visitlab_cli.world.go_to_human import make_go_to_human
    from visitlab_cli.world.navigation import make_navigation
    from visitlab_cli.world.social import make_social
    from visitlab_cli.world.visit import make_visit_world

    human = SixParameters(**HUMAN).create()
    if task == "navigation":
        return make_navigation(TRIAL_STEPS[task])
    if task == "go_to_human":
        return make_go_to_human(TRIAL_STEPS[task], distances=distances, **options)
    if task == "social":
        return make_social(human, TRIAL_STEPS[task], distances=distances, **options)
    world = make_visit_world(human, goal_rooms, distances)
    return make_visit(world, *module_tables(), TRIAL_STEPS[task], **options)


def make_agent(task):
    """Epsilon-greedy on a fixed table: the script where there is a human to win, else nothing but ties.

    A follower is also looked at and greeted again, as the script would not.
    """
    from visitlab_cli.agents.base import Setting
    from visitlab_cli.agents.q_learning import QLearning
    from visitlab_cli.agents.scripted import ScriptedParameters
    from visitlab_cli.world.lab import paper_lab
    from visitlab_cli.world.tasks import TASKS

    size = TASKS[task].size(paper_lab())
    q = np.zeros(size)
    if task in ("social", "visit"):
        q = ScriptedParameters(kind="scripted").create(Setting(task, *size, 1)).q
        follows = np.arange(len(q)) % len(InteractionLevel) == InteractionLevel.FOLLOWS
        q[np.ix_(follows, [Action.LOOK, Action.HELLO])] = 1
    return QLearning(q, np.zeros(size, np.int32), 0.9, EPSILON, 0.0)


def package_log(task, steps, seed=0, **options):
    """The columns of a log by name; `options` as `make_task` takes them."""
    from visitlab_cli.random_numbers import random_state
    from visitlab_cli.simulation.loop import START, play
    from visitlab_cli.world.columns import empty_columns
    from visitlab_cli.world.tasks import columns_of

    record, agent = make_task(task, **options), make_agent(task)
    trials = steps // TRIAL_STEPS[task]
    columns = empty_columns(steps + trials)
    cursor, rows = play(record, agent, START, steps, random_state(seed, task), columns, np.zeros(trials))
    assert cursor.steps == steps
    assert rows == steps + trials
    return {column.name: getattr(columns, column.name) for column in columns_of(task)}


if __name__ == "__main__":
    np.savez(sys.argv[3], **package_log(sys.argv[1], int(sys.argv[2])))
