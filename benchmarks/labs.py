"""What walls and doors cost a step, side by side in one process; and how long a plan to lead takes.

    python -m benchmarks.labs

Agents learn as they would; recording is not measured. The ratio is to the open lab, of the best of some rounds.
"""

import time

import numpy as np

from benchmarks.rows import Row, show
from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.exact.models import go_to_human_mean_q
from visitlab_cli.exact.navigation import navigation_motion, navigation_optimal_q
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.random_numbers import random_state
from visitlab_cli.simulation.controller import make_planned, plan_if_due
from visitlab_cli.simulation.loop import BLOCK_ROWS, START, play
from visitlab_cli.simulation.visit import make_visit
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.layout import rooms_in_rows
from visitlab_cli.world.navigation import make_navigation
from visitlab_cli.world.tasks import TASKS
from visitlab_cli.world.visit import make_visit_world

HUMAN_2 = {"p_S": (0.0, 0.5, 0.5), "p_H": 0.05, "p_M": 0.05, "p_O": 0.15, "p_A": 0.05, "p_P": 0.0}
LEAD = ("route", "mask", "plan", "lead")
ROUNDS = 7
STEPS = {"navigation": 2_000_000, "visit": 500_000}
WALLS = rooms_in_rows(3, 3, 8, 8, True, 2)


def labs():
    return {"open": paper_lab(), "walls": WALLS.lab(), "walls, a door that toggles": WALLS.lab(toggling={"BE": 0.005})}


def world(lab):
    return make_visit_world(SixParameters(**HUMAN_2).create(), lab=lab)


def record_of(task, lab):
    if task == "navigation":
        return make_navigation(lab=lab)
    return make_visit(world(lab), navigation_optimal_q(0.9, lab), go_to_human_mean_q(0.9))


def seconds_a_step(task, record, steps):
    agent = QLearningParameters(kind="q_learning").create(Setting(task, *TASKS[task].size(paper_lab()), steps))
    random, columns = random_state(0, task), empty_columns(BLOCK_ROWS)
    rewards, cursor = np.zeros(steps // record.trial_steps + 1), START
    begun = time.process_time()
    while cursor.steps < steps:
        cursor, _ = play(record, agent, cursor, steps, random, columns, rewards)
    return (time.process_time() - begun) / steps


def plan_seconds(lab):
    after = navigation_motion(lab).after.ravel()
    pairs = lab.n_rooms * len(after)
    model = {
        "successor_offsets": np.minimum(np.arange(pairs + 1), len(after)),
        "successor_states": after,
        "successor_counts": np.ones(len(after), np.int32),
    }
    best = np.inf
    for _ in range(3):  # the first one compiles
        controller = make_planned(LEAD, world(lab), model, 5)
        directions = np.zeros((lab.n_rooms, lab.rows, lab.cols, 8))
        begun = time.process_time()
        plan_if_due(controller, directions)
        best = min(best, time.process_time() - begun)
    return best


def rows():
    for task, steps in STEPS.items():
        records = {name: record_of(task, lab) for name, lab in labs().items()}
        for record in records.values():
            seconds_a_step(task, record, 200)
        best = dict.fromkeys(records, np.inf)
        for _ in range(ROUNDS):
            for name, record in records.items():
                best[name] = min(best[name], seconds_a_step(task, record, steps))
        of_open = best["open"]
        for name, seconds in best.items():
            wanted = "1.3" if name != "open" else ""
            yield Row(f"a step, {task} by q_learning, {name}", 1e9 * seconds, "ns", "open", seconds / of_open, wanted)
    for name, lab in labs().items():
        wanted = "2" if name == "open" else ""
        yield Row(f"a plan to lead, ten sweeps, {name}", plan_seconds(lab), "s of CPU", wanted=wanted)


if __name__ == "__main__":
    show(rows())
