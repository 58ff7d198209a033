"""Choosing from a row of values: greedy with uniform ties, and epsilon-greedy (TASK.md, 'The agents')."""

import numpy as np
import numpy.typing as npt

from visitlab_cli.compiled import kernel
from visitlab_cli.random_numbers import RandomState, happens, random_below

Table = npt.NDArray[np.float64]


@kernel
def maximum(values: Table) -> float:
    """The largest of `values`, shape (n,)."""
    best = float(values[0])
    for value in values[1:]:
        if value > best:
            best = value
    return best


@kernel
def greedy(values: Table, random: RandomState) -> int:
    """An index uniform among the exact maximisers of `values`, shape (n,); draws only where there is a tie."""
    best = maximum(values)
    ties = 0
    first = 0
    for index in range(len(values)):
        if values[index] == best:
            if ties == 0:
                first = index
            ties += 1
    if ties <= 1:
        return first
    left = random_below(random, ties)
    for index in range(first, len(values)):
        if values[index] == best:
            if left == 0:
                return index
            left -= 1
    return first


@kernel
def epsilon_greedy(values: Table, epsilon: float, random: RandomState) -> tuple[int, bool]:
    """With probability `epsilon` any action, uniformly, else `greedy`: `(action, explored)`."""
    if epsilon > 0.0 and happens(random, epsilon):
        return random_below(random, len(values)), True
    return greedy(values, random), False
