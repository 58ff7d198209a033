"""Where each physical action leads from each cell, as navigation has learned it, and what follows from that alone.

The table is pooled over goals, which have no part in how a body moves: what one goal's training tried holds for all.
An action that none has tried is taken for a stay. Cells are row * cols + col.
"""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved
from visitlab_cli.compiled import array_kernel, kernel
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import N_DIRECTIONS, N_MOVES, N_PHYSICAL_ACTIONS, N_SOCIAL_ACTIONS, Action
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.sight import Walls

Cells = npt.NDArray[np.int64]

NO_WAY = np.iinfo(np.int16).max
"""Moves to where none lead."""


class Successors(NamedTuple):
    """What is known of moving; whoever learns more writes `after`, and then calls `follow_up`.

    `after` (cells, 25) is the cell that an action ends in, `meant` (cells, 30) the action that each comes to there,
    `moves` (cells, cells) the fewest from one to another, `sees` (cells, cells) who is in sight of whom.
    `place` (cells, 2) are rows and columns.
    """

    after: Cells
    meant: Cells
    moves: npt.NDArray[np.int16]
    sees: npt.NDArray[np.bool_]
    place: Cells


def make_successors(model: Saved, lab: Lab, *, walled: bool = True) -> Successors:
    """What a navigation module's `model` (`successor_*`) tells of moving in `lab`.

    Where nothing is ever `walled` no way is looked for, and `moves` is empty.
    """
    cells = lab.rows * lab.cols
    place = np.stack(np.divmod(np.arange(cells), lab.cols), axis=1)
    sees = sight_in(lab)
    needed = cells if walled else 0
    found = Successors(
        learned_after(model, cells),
        np.zeros((cells, N_SOCIAL_ACTIONS), np.int64),
        np.zeros((needed, needed), np.int16),
        sees,
        place,
    )
    follow_up(found)
    return found


def sight_in(lab: Lab) -> npt.NDArray[np.bool_]:
    """Whether robot and human in two cells see each other while all doors are open: shape (cells, cells)."""
    cells = lab.rows * lab.cols
    return lab.walls.visible if isinstance(lab.walls, Walls) else np.ones((cells, cells), np.bool_)


def learned_after(model: Saved, cells: int) -> Cells:
    """The cell that each physical action leads to most often, whatever the goal; of equals the first: (cells, 25)."""
    here, action, ends, counts = pooled_counts(model, cells)
    order = np.lexsort((-ends, counts))  # the last of each pair is its most frequent, the first of equals
    after = np.repeat(np.arange(cells), N_PHYSICAL_ACTIONS).reshape(cells, N_PHYSICAL_ACTIONS)
    after[here[order], action[order]] = ends[order]
    return after


def pooled_counts(model: Saved, cells: int) -> tuple[Cells, Cells, Cells, npt.NDArray[np.float64]]:
    """What was seen in a navigation module's training: cells, actions, cells after it, how often, whatever the goal."""
    offsets = model["successor_offsets"]
    pairs = np.repeat(np.arange(len(offsets) - 1), np.diff(offsets))
    state, action = np.divmod(pairs, N_PHYSICAL_ACTIONS)
    here = state % cells * N_PHYSICAL_ACTIONS + action
    seen, which = np.unique(here * cells + model["successor_states"] % cells, return_inverse=True)
    counts = np.bincount(which, model["successor_counts"], len(seen))
    start, taken = np.divmod(seen // cells, N_PHYSICAL_ACTIONS)
    return start, taken, seen % cells, counts.astype(np.float64)


@array_kernel
def follow_up(known: Successors) -> None:
    """Make `meant` and `moves` anew from `after`."""
    cells = len(known.after)
    for cell in range(cells):
        for action in range(N_SOCIAL_ACTIONS):
            known.meant[cell, action] = action
            if action < N_MOVES:
                gone = apart(known, cell, known.after[cell, action])
                known.meant[cell, action] = N_DIRECTIONS * (gone - 1) + action % N_DIRECTIONS
                if gone == 0:
                    known.meant[cell, action] = Action.STAY.value
    after, moves, waiting = known.after, known.moves, np.empty(cells, np.int64)
    for start in range(len(moves)):
        moves[start, :] = NO_WAY
        moves[start, start] = 0
        waiting[0], done, found = start, 0, 1
        while done < found:
            cell = waiting[done]
            done += 1
            for action in range(N_MOVES):
                ahead = after[cell, action]
                if moves[start, ahead] == NO_WAY:
                    moves[start, ahead] = moves[start, cell] + 1
                    waiting[found] = ahead
                    found += 1


@kernel
def apart(known: Successors, one: int, other: int) -> int:
    """The Chebyshev distance of two cells."""
    rows, cols = known.place[one, 0] - known.place[other, 0], known.place[one, 1] - known.place[other, 1]
    return max(abs(rows), abs(cols))  # type: ignore[no-any-return]


@kernel
def towards(known: Successors, cell: int, goal: int, random: RandomState) -> int:
    """The physical action after which the fewest moves are left to `goal`, ties at random; -1 where no way is known."""
    fewest, ties = NO_WAY, 0
    for action in range(N_PHYSICAL_ACTIONS):
        left = known.moves[known.after[cell, action], goal]
        if left < fewest:
            fewest, ties = left, 0
        ties += left == fewest
    if fewest == NO_WAY:
        return -1
    chosen = random_below(random, ties) if ties > 1 else 0
    for action in range(N_PHYSICAL_ACTIONS):
        if known.moves[known.after[cell, action], goal] == fewest:
            if chosen == 0:
                return action
            chosen -= 1
    return -1
