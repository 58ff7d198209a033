"""A small lab of two rooms, what is to be known of moving in it, and a visit there whose controller plans.

Run as a program it plays a visit that leads: `python -m tests.simulation.small_lab OUT.npz`.
"""

import sys

import numpy as np

HUMAN = {"p_S": (0.2, 0.3, 0.5), "p_H": 0.1, "p_M": 0.2, "p_O": 0.3, "p_A": 0.1}


def two_rooms(rows=6, cols=6):
    """A wall between the rooms, but for a doorway of two cells in the middle."""
    from visitlab_cli.world.lab import make_lab

    half, middle = cols // 2, rows // 2
    walls = [((row, half - 1), (row, half)) for row in range(rows) if row not in (middle - 1, middle)]
    return make_lab(rows, cols, walls, rooms=np.tile(np.arange(cols) // half, (rows, 1)))


def model_of(lab):
    """What a navigation module knows that has tried every action once in each cell, with the first goal only."""
    from visitlab_cli.exact.navigation import navigation_motion

    after = navigation_motion(lab).after.ravel()
    pairs = lab.n_rooms * len(after)
    return {
        "successor_offsets": np.minimum(np.arange(pairs + 1), len(after)),
        "successor_states": after,
        "successor_counts": np.ones(len(after), np.int32),
    }


def visit_in(lab, *options, human=HUMAN, told=None, model=None, window=0, learns=None):
    """A visit of 50 steps a trial; navigation's and go_to_human's own values are zero."""
    from visitlab_cli.humans.six_parameters import SixParameters
    from visitlab_cli.simulation.controller import make_planned
    from visitlab_cli.simulation.visit import make_visit
    from visitlab_cli.world.visit import make_visit_world

    world = make_visit_world(SixParameters(**human).create(), lab=lab)
    known = model_of(lab) if model is None else model
    planned = make_planned(options, world, known, 5, told, window, learns=learns) if options else None
    q = np.zeros((lab.n_rooms * lab.rows * lab.cols, 25)), np.zeros((320, 25))
    return make_visit(world, *q, 50, controller=planned)


def played(visit, trials, seed=0, parts=("plan",)):
    """The columns of a log in which a script that explores plays a visit; `visit` holds what it has learned."""
    from tests.world.package_log import make_agent
    from visitlab_cli.random_numbers import random_state
    from visitlab_cli.simulation.loop import START, play
    from visitlab_cli.world.columns import COLUMNS, empty_columns
    from visitlab_cli.world.tasks import TASKS

    rows = trials * (visit.trial_steps + 1)
    columns = empty_columns(rows)
    steps = trials * visit.trial_steps
    play(visit, make_agent("visit"), START, steps, random_state(seed), columns, np.zeros(trials))
    there = (*TASKS["visit"].parts, *parts)
    return {column.name: getattr(columns, column.name) for column in COLUMNS if column.part in there}


if __name__ == "__main__":
    leading = visit_in(two_rooms(4, 4), "route", "mask", "plan", "lead")
    np.savez(sys.argv[1], **played(leading, 11), values=leading.controller.leading.values)
