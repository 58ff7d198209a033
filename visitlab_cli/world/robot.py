"""What an action does to the robot's body; gestures move nothing."""

from visitlab_cli.compiled import kernel
from visitlab_cli.world.enums import N_DIRECTIONS, N_MOVES, Action
from visitlab_cli.world.lab import Lab, move
from visitlab_cli.world.scene import Body, Scene, robot_of


@kernel
def is_move(action: int) -> bool:
    """Whether an action is one of the 24 moves."""
    return 0 <= action < N_MOVES


@kernel
def move_of(direction: int, speed: int) -> int:
    """The move in `direction` (0..7) at `speed` (1..3) cells a step."""
    return N_DIRECTIONS * (speed - 1) + direction


@kernel
def moved(lab: Lab, body: Body, action: int, open_doors: int) -> Body:
    """A body after a move: it heads in the move's direction, also when blocked."""
    direction, speed = action % N_DIRECTIONS, action // N_DIRECTIONS + 1
    row, col = move(lab, body.row, body.col, direction, speed, open_doors)
    return Body(row, col, direction)


@kernel
def acted(lab: Lab, scene: Scene, action: int) -> Body:
    """The robot after `action` in `scene`; a look turns it to the human."""
    body = robot_of(scene)
    if is_move(action):
        return moved(lab, body, action, scene.open_doors)
    if action == Action.LOOK:
        return Body(body.row, body.col, scene.angle)
    return body
