"""The loop: a block more or less, or a pause, never changes a result."""

import pickle

import numpy as np
import pytest

from tests.world.package_log import make_task, package_log
from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.random_numbers import random_state
from visitlab_cli.simulation.loop import START, play
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASKS

STEPS = 3000
PARAMETERS = ModelBasedParameters(kind="model_based", plan_every=200)


def played(task, block_rows, pause_at=None):
    """Everything that a cell leaves: rows, rewards, the agent's arrays and the random state."""
    record, random = make_task(task), random_state(5, task)
    agent = PARAMETERS.create(Setting(task, *TASKS[task].size(paper_lab()), STEPS))
    cursor, rewards, rows = START, np.zeros(STEPS // record.trial_steps), []
    columns = empty_columns(block_rows)
    while cursor.steps < STEPS:
        cursor, count = play(record, agent, cursor, STEPS, random, columns, rewards)
        rows.append(np.stack([array[:count].astype(float) for array in columns]))
        if pause_at is not None and cursor.steps >= pause_at:
            checkpoint = pickle.dumps((cursor, agent, random, rewards))
            del cursor, agent, random, rewards
            cursor, agent, random, rewards = pickle.loads(checkpoint)
            pause_at = None
    return {
        "rows": np.concatenate(rows, axis=1),
        "rewards": rewards,
        "random": random,
        **PARAMETERS.save(agent),
    }


def same(one, other):
    return all(np.array_equal(one[name], other[name]) for name in one)


@pytest.mark.parametrize("task", ["navigation", "go_to_human", "social", "visit"])
def test_blocks_and_pauses_change_nothing(task):
    whole = played(task, 8192)
    assert same(whole, played(task, 7))
    assert same(whole, played(task, 128, pause_at=1000))


def test_rows_are_numbered_and_rewards_add_up():
    log = package_log("social", 2000)
    assert log["step"].tolist() == list(range(21)) * 100
    assert log["trial"].tolist() == np.repeat(np.arange(100), 21).tolist()
    whole = played("social", 8192)
    assert whole["rewards"].sum() == whole["rows"][6].sum()
    assert whole["visits"].sum() == STEPS


def test_other_seeds_and_names_are_other_streams():
    streams = {tuple(random_state(seed, *names)) for seed in (0, 1) for names in (("a",), ("b",), ("a", "b"), ("ab",))}
    assert len(streams) == 8


def test_random_numbers_are_numpys():
    generator = np.random.SFC64(np.random.SeedSequence(7))
    state = np.array(generator.state["state"]["state"], np.uint64)
    from visitlab_cli.random_numbers import random_unit

    expected = np.random.Generator(generator).random(1000)
    assert [random_unit(state) for _ in range(1000)] == expected.tolist()
