"""The shapes of a scene: where the log says, one of each, both bodies to be seen."""

import numpy as np
import pytest

from tests.scene.test_words import BEGIN, visit
from visitlab_cli.scene.scene import NARROW, Scene
from visitlab_cli.scene.shapes import Body, Role
from visitlab_cli.scene.trial import Trial
from visitlab_cli.world.enums import Action, Direction
from visitlab_cli.world.geometry import DISTANCES
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import VISIT


def scene_of(*rows):
    steps = visit(BEGIN, *rows)
    headings = {f"{who}_heading": np.full(len(steps["step"]), Direction.WEST) for who in ("robot", "human")}
    return Scene(Trial(None, "visit", VISIT, 0, {**steps, **headings}, paper_lab(), DISTANCES))


def by_role(shapes):
    found = {}
    for shape in shapes:
        found.setdefault(shape.role, []).append(shape)
    return found


def test_each_thing_is_there_once_and_where_it_is():
    scene = scene_of({"robot_row": 7, "robot_col": 1, "reward": 1, "goal_room": 8}, {"action": Action.HELLO})
    first, second = by_role(scene.moment(1)), by_role(scene.moment(2))
    areas, ways, bodies = (Role.GOAL, Role.REACHED), (Role.ROBOT_WAY, Role.HUMAN_WAY), (Role.ROBOT, Role.HUMAN)
    others = Role.CLOTH, Role.POLE, Role.SIGHT, Role.DESIRED
    assert {role: len(shapes) for role, shapes in first.items()} == dict.fromkeys((*areas, *ways, *bodies, *others), 1)
    assert set(second) == set(first) - {Role.REACHED} | {Role.ROBOT_SAYS}
    assert first[Role.GOAL][0].corner.tolist() == [16, 16]
    assert first[Role.REACHED][0].corner.tolist() == [8, 8]
    assert first[Role.ROBOT][0].place.tolist() == [1.5, 7.5]
    assert first[Role.ROBOT][0].tip.tolist() == pytest.approx([-0.2, 7.5])
    assert first[Role.ROBOT_WAY][0].points.tolist() == [[5.5, 5.5], [1.5, 7.5]]
    assert (second[Role.ROBOT_SAYS][0].text, second[Role.ROBOT_SAYS][0].above) == ("HELLO!", True)
    way = first[Role.DESIRED][0].end - first[Role.DESIRED][0].start
    assert way[0] < 0 < way[1], "south-west"


@pytest.mark.parametrize(("col", "shared"), [(5, True), (6, False), (4, False)])
def test_who_share_a_cell_stand_apart_and_are_narrower(col, shared):
    scene = scene_of({"robot_row": 8, "robot_col": col})
    robot, human = (shape for role in (Role.ROBOT, Role.HUMAN) for shape in by_role(scene.moment(1))[role])
    assert isinstance(robot, Body)
    assert scene.share_a_cell(1) == shared
    assert robot.scale == human.scale == (NARROW if shared else 1)
    assert abs(robot.place - human.place).max() > 0.75 * robot.scale


def test_pointing_is_along_what_was_desired_before_the_goal_changed():
    scene = scene_of({"action": Action.POINT, "desired_direction": Direction.EAST})
    (pointed,) = by_role(scene.moment(1))[Role.POINTED]
    assert (pointed.end - pointed.start)[0] < 0, "south-west, as the step began"


def test_the_place_has_nine_named_rooms():
    place = by_role(scene_of().place())
    assert [room.text for room in place[Role.ROOM]] == [f"Room {number}" for number in range(9)]
    assert place[Role.ROOM][5].corner.tolist() == [16, 8]
    assert place[Role.FLOOR][0].size.tolist() == [24, 24]
