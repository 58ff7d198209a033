"""Exact values against linear solves on a small grid."""

import itertools

import numpy as np
import pytest

from tests.oracle.grid import Grid
from tests.oracle.rules import robot_after
from visitlab_cli.exact.motion import Motion, optimal_q, optimal_sums, random_discounted, random_sums

SIDE, ACTIONS, STEPS = 5, 25, 6
CELLS = SIDE * SIDE
CONTEXTS = 3


@pytest.fixture(scope="module")
def motion():
    """A room of 5 x 5 cells by the oracle's moves, with three sets of cells that pay."""
    grid = Grid.with_walls(SIDE, SIDE, [((0, 1), (0, 2)), ((3, 3), (4, 3))])
    after = np.array(
        [
            [SIDE * r + c for r, c in (robot_after(grid, divmod(cell, SIDE), 0, a, 0)[0] for a in range(ACTIONS))]
            for cell in range(CELLS)
        ]
    )
    reward = (np.random.default_rng(0).random((CELLS, CONTEXTS)) < 0.1).astype(np.uint8)
    reward[7] = 1
    return Motion(after, reward)


def transition_of(motion, policy):
    """The chain of a stochastic policy, shape (cells, actions)."""
    chain = np.zeros((CELLS, CELLS))
    for cell, action in itertools.product(range(CELLS), range(ACTIONS)):
        chain[cell, motion.after[cell, action]] += policy[cell, action]
    return chain


def sums_of(chains, reward):
    """Expected sums over the horizon as one linear system over (step, cell): V_t - P_t V_{t+1} = P_t r."""
    size = len(chains) * CELLS
    system, right = np.eye(size), np.zeros(size)
    for step, chain in enumerate(chains):
        here = slice(step * CELLS, (step + 1) * CELLS)
        right[here] = chain @ reward
        if step + 1 < len(chains):
            system[here, (step + 1) * CELLS : (step + 2) * CELLS] = -chain
    return np.linalg.solve(system, right)[:CELLS]


def test_random_sums_are_those_of_a_linear_solve(motion):
    chain = transition_of(motion, np.full((CELLS, ACTIONS), 1 / ACTIONS))
    expected = sums_of([chain] * STEPS, motion.reward.mean(axis=1))
    assert random_sums(motion, STEPS) == pytest.approx(expected)


@pytest.mark.parametrize("context", range(CONTEXTS))
def test_optimal_sums_are_reached_by_a_policy_and_by_none_surpassed(motion, context):
    values = [optimal_sums(motion, left)[:, context].astype(int) for left in range(STEPS + 1)]
    reward = motion.reward[:, context].astype(int)
    for left in range(1, STEPS + 1):
        by_action = (reward + values[left - 1])[motion.after]
        assert (by_action.max(axis=1) == values[left]).all()
    greedy = [np.eye(ACTIONS)[(reward + values[left - 1])[motion.after].argmax(axis=1)] for left in range(STEPS, 0, -1)]
    reached = sums_of([transition_of(motion, policy) for policy in greedy], reward)
    assert values[STEPS] == pytest.approx(reached)


@pytest.mark.parametrize("gamma", [0.0, 0.9, 0.99])
def test_discounted_values_are_those_of_policy_iteration(motion, gamma):
    q, chance = optimal_q(motion, gamma), random_discounted(motion, gamma)
    uniform = transition_of(motion, np.full((CELLS, ACTIONS), 1 / ACTIONS))
    for context in range(CONTEXTS):
        reward = motion.reward[:, context].astype(float)
        policy = np.zeros(CELLS, int)
        while True:
            chain = transition_of(motion, np.eye(ACTIONS)[policy])
            values = np.linalg.solve(np.eye(CELLS) - gamma * chain, chain @ reward)
            by_action = (reward + gamma * values)[motion.after]
            better = by_action.max(axis=1) > values + 1e-9
            if not better.any():
                break
            policy = np.where(better, by_action.argmax(axis=1), policy)
        assert q[context] == pytest.approx(by_action, abs=1e-8)
        # the same chain, followed for so long that nothing is left to come
        longer, expected = np.zeros(CELLS), uniform @ reward
        for _ in range(3000):
            longer = expected + gamma * uniform @ longer
        assert chance[context] == pytest.approx(longer, abs=1e-8)
