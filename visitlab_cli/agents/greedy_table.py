"""An agent that follows a fixed table: greedy, never exploring, never learning. Frozen and scripted ones are this."""

from typing import NamedTuple

from visitlab_cli.agents.base import CHOOSE, LEARN
from visitlab_cli.agents.exploration import Table, greedy
from visitlab_cli.random_numbers import RandomState


class GreedyTable(NamedTuple):
    """`q` has shape (states, actions)."""

    q: Table


@CHOOSE.of(GreedyTable)
def choose(agent: GreedyTable, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Uniform among the best."""
    return greedy(agent.q[state], random), False


@LEARN.of(GreedyTable)
def learn(
    agent: GreedyTable,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Learn nothing."""
