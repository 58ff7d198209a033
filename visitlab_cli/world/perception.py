"""What the robot perceives of the human's engagement: the interaction level, geometry alone, or what it believes.

A task holds one of these records; `perceived_level` of its scenes is what its states are made of, and controllers see.
"""

from typing import Any, NamedTuple

from visitlab_cli.compiled import Operation, kernel
from visitlab_cli.world.belief import NONE, Belief, begin, follow
from visitlab_cli.world.enums import InteractionLevel
from visitlab_cli.world.geometry import Geometry, sight
from visitlab_cli.world.lab import Lab, sees
from visitlab_cli.world.scene import Scene, with_belief, with_perceived


class Levels(NamedTuple):
    """The interaction level, as in the paper: nothing is hidden, and this costs nothing."""

    none: int = 0


class Sights(NamedTuple):
    """Who sees and faces whom, whatever the engagement: levels 0 to 4, without memory."""

    none: int = 0


Perception = Levels | Sights | Belief


def _begun(perception, lab, geometry, scene):  # type: ignore[no-untyped-def]
    """The first scene of a trial as it is perceived."""


def _perceived(perception, lab, geometry, before, after):  # type: ignore[no-untyped-def]
    """The scene `after` a step from `before`, as it is perceived."""


BEGUN, PERCEIVED = Operation(_begun), Operation(_perceived)
begun, perceived = BEGUN.function, PERCEIVED.function


@kernel
def level_in_sight(lab: Lab, geometry: Geometry, scene: Scene) -> int:
    """The level that geometry alone makes, 0 to 4."""
    if not sees(lab, scene.robot_row, scene.robot_col, scene.human_row, scene.human_col, scene.open_doors):
        return InteractionLevel.NOT_SEEN.value
    north, east = scene.robot_row - scene.human_row, scene.human_col - scene.robot_col
    level: int = sight(geometry, north, east, scene.robot_heading, scene.human_heading)
    return level


@kernel
def _believed(belief: Belief, level: int, scene: Scene) -> Scene:
    """The scene with the belief, and with the level of the likeliest engagement, of equals the first."""
    likeliest = 0
    for engagement in range(len(belief.now)):
        if belief.now[engagement] > belief.now[likeliest]:
            likeliest = engagement
    seen = level if likeliest == NONE else likeliest + InteractionLevel.BOTH_FACE.value
    now = belief.now
    return with_belief(with_perceived(scene, seen), now[0], now[1], now[2], now[3])


@BEGUN.of(Levels)
def _as_it_begins(perception: Levels, lab: Lab, geometry: Geometry, scene: Scene) -> Scene:
    return scene


@PERCEIVED.of(Levels)
def _as_it_is(perception: Levels, lab: Lab, geometry: Geometry, before: Scene, after: Scene) -> Scene:
    return after


@BEGUN.of(Sights)
def _seen_at_first(perception: Sights, lab: Lab, geometry: Geometry, scene: Scene) -> Scene:
    return with_perceived(scene, level_in_sight(lab, geometry, scene))


@PERCEIVED.of(Sights)
def _seen(perception: Sights, lab: Lab, geometry: Geometry, before: Scene, after: Scene) -> Scene:
    return with_perceived(after, level_in_sight(lab, geometry, after))


@BEGUN.of(Belief)
def _believed_at_first(belief: Belief, lab: Lab, geometry: Geometry, scene: Scene) -> Scene:
    begin(belief)
    return _believed(belief, level_in_sight(lab, geometry, scene), scene)


@PERCEIVED.of(Belief)
def _followed(belief: Belief, lab: Lab, geometry: Geometry, before: Scene, after: Scene) -> Scene:
    follow(belief, lab, before, after, level_in_sight(lab, geometry, before))
    return _believed(belief, level_in_sight(lab, geometry, after), after)


def played_as(perception: Any) -> str:
    """What tells the types of its record from those of one to whom nothing is hidden."""
    return {Sights: "sights", Belief: "belief"}.get(type(perception), "")
