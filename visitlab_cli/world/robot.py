"""What an action does to the robot's body; gestures move nothing."""

from visitlab_cli.compiled import kernel
from visitlab_cli.world.enums import N_DIRECTIONS, N_MOVES, Action
from visitlab_cli.world.grid import Grid, move
from visitlab_cli.world.scene import Body


@kernel
def is_move(action: int) -> bool:
    """Whether an action is one of the 24 moves."""
    return 0 <= action < N_MOVES


@kernel
def move_of(direction: int, speed: int) -> int:
    """The move in `direction` (0..7) at `speed` (1..3) cells a step."""
    return N_DIRECTIONS * (speed - 1) + direction


@kernel
def moved(grid: Grid, body: Body, action: int) -> Body:
    """A body after a move: it heads in the move's direction, also when blocked."""
    direction, speed = action % N_DIRECTIONS, action // N_DIRECTIONS + 1
    row, col = move(grid, body.row, body.col, direction, speed)
    return Body(row, col, direction)


@kernel
def acted(grid: Grid, body: Body, action: int, angle: int) -> Body:
    """The robot after `action`; `angle` (0..7), the direction to the human, is where a look turns it."""
    if is_move(action):
        return moved(grid, body, action)
    if action == Action.LOOK:
        return Body(body.row, body.col, angle)
    return body
