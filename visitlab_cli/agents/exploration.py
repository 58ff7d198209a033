"""Choosing from a row of values: greedy with uniform ties, and epsilon-greedy (TASK.md, 'The agents')."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, happens, random_below

Table = npt.NDArray[np.float64]


@kernel
def maximum(values: Table) -> float:
    """The largest of `values`, shape (n,); four parts side by side, for in one each comparison waits for the last."""
    first = second = third = fourth = float(values[0])
    fours = len(values) - len(values) % 4
    for index in range(0, fours, 4):
        first = values[index] if values[index] > first else first
        second = values[index + 1] if values[index + 1] > second else second
        third = values[index + 2] if values[index + 2] > third else third
        fourth = values[index + 3] if values[index + 3] > fourth else fourth
    for index in range(fours, len(values)):
        first = values[index] if values[index] > first else first
    return max(max(first, second), max(third, fourth))


@kernel
def greedy(values: Table, random: RandomState) -> int:
    """An index uniform among the exact maximisers of `values`, shape (n,); draws only where there is a tie."""
    best = maximum(values)
    ties = 0
    for value in values:
        ties += value == best
    left = random_below(random, ties) if ties > 1 else 0
    for index in range(len(values)):
        if values[index] == best:
            if left == 0:
                return index
            left -= 1
    return 0


@kernel
def epsilon_greedy(values: Table, epsilon: float, random: RandomState) -> tuple[int, bool]:
    """With probability `epsilon` any action, uniformly, else `greedy`: `(action, explored)`."""
    if epsilon > 0.0 and happens(random, epsilon):
        return random_below(random, len(values)), True
    return greedy(values, random), False


@kernel
def epsilon_greedy_as(
    values: Table, meant: npt.NDArray[np.int64], epsilon: float, random: RandomState
) -> tuple[int, bool]:
    """`epsilon_greedy` where each action is valued as the one it comes to: `(what that is, explored)`.

    `values` and `meant`, which action each comes to, have the shape (n,).
    """
    if epsilon > 0.0 and happens(random, epsilon):
        return meant[random_below(random, len(values))], True
    best = values[meant[0]]
    for action in meant:
        best = max(best, values[action])
    ties = 0
    for action in meant:
        ties += values[action] == best
    left = random_below(random, ties) if ties > 1 else 0
    for action in meant:
        if values[action] == best:
            if left == 0:
                return action, False
            left -= 1
    return meant[0], False
