"""A scene: where robot and human are, what they just did and how they stand to each other. Immutable.

A new field is written here, and nowhere else is a scene's field list repeated: what the human decides of the next
scene is a `Reaction`, whose fields are copied by name; and a column of the log that is called as a field is
filled from it (`simulation/loop.py`).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from visitlab_cli.compiled import kernel, written
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.enums import N_DIRECTIONS, Action, Engagement, InteractionLevel
from visitlab_cli.world.geometry import TOO_FAR, Geometry, sight
from visitlab_cli.world.lab import ALL_OPEN, Lab, random_cell, sees, toggled


class Scene(NamedTuple):
    """One moment of a task, all whole numbers but for the belief; a task leaves what it lacks at 0."""

    robot_row: int = 0
    robot_col: int = 0
    robot_heading: int = 0
    human_row: int = 0
    human_col: int = 0
    human_heading: int = 0
    engagement: int = 0
    executed_action: int = 0  # of the robot in the step that led here
    human_action: int = 0  # of the human in that step
    interaction_level: int = 0
    perceived_level: int = 0  # what the robot takes it for, the same where engagement is not hidden
    distance: int = 0
    angle: int = 0
    desired_direction: int = 0
    goal_room: int = 0
    human_memory: int = 0  # 64 bits that a human's rules may use, 0 at a trial's start
    open_doors: int = ALL_OPEN  # a bit for each of the lab's doors that is open
    plan_leads: bool = False  # whether a plan picks the next action; where it wants both to go by it
    wanted_robot_row: int = 0
    wanted_robot_col: int = 0
    wanted_human_row: int = 0
    wanted_human_col: int = 0
    belief_none: float = 0.0  # where engagement is hidden: how likely each is
    belief_greeted: float = 0.0
    belief_called: float = 0.0
    belief_following: float = 0.0


class Reaction(NamedTuple):
    """What the human decides in a step: fields of the next scene, by the same names; `reaction` makes it in kernels."""

    human_row: int
    human_col: int
    human_heading: int
    engagement: int
    human_action: int  # its move at the speed it drew, blocked or not, or STAY
    human_memory: int = 0


class Body(NamedTuple):
    """A cell and a heading."""

    row: int
    col: int
    heading: int


NOWHERE = Scene(desired_direction=-1, goal_room=-1)
"""What a task's first trial follows: no goal room and no desired direction to carry over."""


def _with(*fields: str, of: str = "") -> Callable[..., Scene]:
    """A kernel `(scene, *fields)`, or `(scene, of)` that takes them from a record: the scene with these changed."""
    arguments = of or ", ".join(fields)
    values = {name: f"scene.{name}" for name in Scene._fields}
    values |= {name: f"{of}.{name}" if of else name for name in fields}
    made = ", ".join(f"{name}={value}" for name, value in values.items())
    return written("scene_with", f"scene, {arguments}", [f"return Scene({made})"], Scene=Scene)


def _making(record: type[NamedTuple]) -> Callable[..., Any]:
    """A kernel that makes a record from its fields, in which those with a default may be left out."""
    defaults = record._field_defaults
    arguments = [f"{name}={defaults[name]}" if name in defaults else name for name in record._fields]
    made = ", ".join(f"{name}={name}" for name in record._fields)
    return written(
        record.__name__.lower(),
        ", ".join(arguments),
        [f"return {record.__name__}({made})"],
        **{record.__name__: record},
    )


reaction: Callable[..., Reaction] = _making(Reaction)
"""What the human decides, from the fields of `Reaction`, by name; those with a default may be left out."""
with_aims: Callable[[Scene, int, int], Scene] = _with("desired_direction", "goal_room")
"""The same scene with another desired direction and goal room."""
with_wanted: Callable[..., Scene] = _with(
    "plan_leads", "wanted_robot_row", "wanted_robot_col", "wanted_human_row", "wanted_human_col"
)
"""The same scene with what a plan wants: `(scene, plan_leads, robot's row, col, human's row, col)`."""
with_perceived: Callable[[Scene, int], Scene] = _with("perceived_level")
"""The same scene with another level that the robot perceives."""
with_belief: Callable[..., Scene] = _with("belief_none", "belief_greeted", "belief_called", "belief_following")
"""The same scene with a belief: `(scene, none, greeted, called, following)`."""
_with_doors: Callable[[Scene, int], Scene] = _with("open_doors")
_with_robot: Callable[..., Scene] = _with("robot_row", "robot_col", "robot_heading", "executed_action")
_with_human: Callable[..., Scene] = _with(*Reaction._fields, of="reaction")
_with_relation: Callable[..., Scene] = _with("interaction_level", "perceived_level", "distance", "angle")


@kernel
def acted_scene(scene: Scene, robot: Body, action: int) -> Scene:
    """The scene with the robot's body after its executed `action`; how it stands to the human is left as it was."""
    return _with_robot(scene, robot.row, robot.col, robot.heading, action)


@kernel
def related(lab: Lab, geometry: Geometry, scene: Scene) -> Scene:
    """The scene with the distance, angle and interaction level that follow from bodies and engagement.

    Where a wall is between the two the human does not see the robot, and the distance is perceived as too far.
    """
    north, east = scene.robot_row - scene.human_row, scene.human_col - scene.robot_col
    place = north + geometry.reach, east + geometry.reach
    distance = int(geometry.distance[place])
    visible = sees(lab, scene.robot_row, scene.robot_col, scene.human_row, scene.human_col, scene.open_doors)
    if not visible:
        distance = TOO_FAR
    if scene.engagement != Engagement.NONE:
        level = scene.engagement + InteractionLevel.BOTH_FACE.value
    elif visible:
        level = sight(geometry, north, east, scene.robot_heading, scene.human_heading)
    else:
        level = InteractionLevel.NOT_SEEN.value
    return _with_relation(scene, level, level, distance, int(geometry.angle[place]))


@kernel
def first_scene(lab: Lab, geometry: Geometry, last: Scene, robot: Body, human: Body) -> Scene:
    """The scene that a trial starts in: nobody engaged, nothing done; the aims and doors are those of `last`."""
    no_action = Action.NO_ACTION.value
    unmoved = reaction(human.row, human.col, human.heading, Engagement.NONE.value, no_action)
    return related(lab, geometry, _with_human(acted_scene(last, robot, no_action), unmoved))


@kernel
def next_scene(lab: Lab, geometry: Geometry, scene: Scene, robot: Body, action: int, decided: Reaction) -> Scene:
    """The scene after a step: the robot's body after its executed `action`, and what the human `decided`."""
    return related(lab, geometry, _with_human(acted_scene(scene, robot, action), decided))


@kernel
def robot_of(scene: Scene) -> Body:
    """The robot's body."""
    return Body(scene.robot_row, scene.robot_col, scene.robot_heading)


@kernel
def human_of(scene: Scene) -> Body:
    """The human's body."""
    return Body(scene.human_row, scene.human_col, scene.human_heading)


@kernel
def before_trial(lab: Lab, last: Scene, random: RandomState) -> Scene:
    """What a trial that follows `last` finds: some of the lab's doors may have been opened or shut."""
    return _with_doors(last, toggled(lab, last.open_doors, random))


@kernel
def random_direction(random: RandomState) -> int:
    """A direction, uniform over the eight."""
    return random_below(random, N_DIRECTIONS)


@kernel
def random_body(lab: Lab, random: RandomState) -> Body:
    """A cell in which a trial may begin and a heading, uniform."""
    row, col = random_cell(lab, random)
    return Body(row, col, random_direction(random))
