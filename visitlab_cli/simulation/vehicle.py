"""The human as a vehicle: where should it go from each cell, if it went where it is told at its own speeds?

V(g, h) = max_d sum_k p_S(k) [1 if h' in g else gamma V(g, h')], where h' is the cell that a move of speed k in
direction d is known to lead to from h. What an average of navigation's values over speeds is for the paper's visit.
"""

import numpy as np

from visitlab_cli.agents.exploration import Table
from visitlab_cli.compiled import array_kernel
from visitlab_cli.simulation.successors import Cells
from visitlab_cli.world.enums import MAX_SPEED, N_DIRECTIONS

DISCOUNT = 0.9
SETTLED = 1e-12
"""Values that a sweep changes by less are done."""


@array_kernel
def plan_directions(after: Cells, rooms: Cells, speeds: Table, values: Table) -> None:
    """Fill `values`, shape (goal rooms, cells, 8): what each direction is worth.

    Args:
        after: the cell that each physical action leads to, shape (cells, 25).
        rooms: the room of each cell, shape (cells,).
        speeds: the chance of each speed, shape (3,).
        values: overwritten.
    """
    best = np.zeros(values.shape[1])
    for room in range(values.shape[0]):
        best[:] = 0.0
        change = 1.0
        while change > SETTLED:
            change = 0.0
            for cell in range(values.shape[1]):
                for direction in range(N_DIRECTIONS):
                    worth = 0.0
                    for slower in range(MAX_SPEED):
                        ahead = after[cell, N_DIRECTIONS * slower + direction]
                        worth += speeds[slower] * (1.0 if rooms[ahead] == room else DISCOUNT * best[ahead])
                    values[room, cell, direction] = worth
            for cell in range(values.shape[1]):
                highest = values[room, cell].max()
                change = max(change, abs(highest - best[cell]))
                best[cell] = highest
