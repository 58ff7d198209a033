"""The ROS 2 bag, read back by rosbags: where robot and human are and head, the map, the markers."""

import math
import sys

import numpy as np
import pytest

from tests.export.test_foxglove import STEPS, shown
from tests.program import visitlab
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.export.ros2_messages import PARTS, occupied
from visitlab_cli.export.ros2bag import write_ros2bag
from visitlab_cli.world.lab import make_lab

highlevel = pytest.importorskip("rosbags.highlevel")
ROWS = 24
ARROW, TEXT, DELETE_ALL = 0, 9, 3


def read(path):
    """For each topic its type, times and messages."""
    found = {}
    with highlevel.AnyReader([path]) as reader:
        for connection, time, raw in reader.messages():
            message = reader.deserialize(raw, connection.msgtype)
            found.setdefault(connection.topic, []).append((connection.msgtype, time, message))
    return found


@pytest.fixture(scope="module", params=[1.0, 0.5])
def written(request, tmp_path_factory):
    trials = [shown("visit"), shown("visit", 5)]
    path = tmp_path_factory.mktemp("ros") / "bag"
    assert write_ros2bag(path, trials, request.param) == 2 * (STEPS + 1)
    return trials, read(path), request.param


def test_the_topics_are_of_their_types_and_at_each_step_or_trial(written):
    _, found, _ = written
    told = {topic: ({kind for kind, *_ in sent}, [time for _, time, _ in sent]) for topic, sent in found.items()}
    every = [row * 10**9 for row in range(2 * (STEPS + 1))]
    assert told == {
        "/robot/pose": ({"geometry_msgs/msg/PoseStamped"}, every),
        "/human/pose": ({"geometry_msgs/msg/PoseStamped"}, every),
        "/scene": ({"visualization_msgs/msg/MarkerArray"}, every),
        "/lab": ({"visualization_msgs/msg/MarkerArray"}, every[:: STEPS + 1]),
        "/map": ({"nav_msgs/msg/OccupancyGrid"}, every[:: STEPS + 1]),
    }


@pytest.mark.parametrize("who", ["robot", "human"])
def test_poses_go_east_and_north_in_metres_and_head_counter_clockwise(written, who):
    trials, found, size = written
    steps = trials[0].steps
    for (_, time, message), row in zip(found[f"/{who}/pose"], range(STEPS + 1), strict=False):
        assert message.header.frame_id == "map"
        assert message.header.stamp.sec * 10**9 + message.header.stamp.nanosec == time
        place, turn = message.pose.position, message.pose.orientation
        assert (place.x / size - 0.5, place.z) == (steps[f"{who}_col"][row], 0)
        assert ROWS - place.y / size - 0.5 == steps[f"{who}_row"][row]
        assert (turn.x, turn.y) == (0, 0)
        assert 2 * math.atan2(turn.z, turn.w) == pytest.approx(steps[f"{who}_heading"][row] * math.pi / 4)


def test_the_map_covers_the_lab_from_the_south_west(written):
    _, found, size = written
    _, _, grid = found["/map"][0]
    assert (grid.info.width, grid.info.height) == (ROWS * PARTS, ROWS * PARTS)
    assert grid.info.resolution == pytest.approx(size / PARTS)
    assert (grid.info.origin.position.x, grid.info.origin.position.y, grid.info.origin.orientation.w) == (0, 0, 1)
    cells = grid.data.reshape(grid.info.height, grid.info.width)
    inside = cells[1:-1, 1:-1]
    assert not inside.any()
    assert (cells == 100).sum() == cells.size - inside.size


def test_a_wall_is_occupied_on_both_sides_of_where_it_stands():
    cells = occupied(make_lab(3, 3, walls=[((0, 1), (1, 1)), ((2, 0), (2, 1))])) == 100
    assert cells[PARTS - 1 : PARTS + 1, PARTS : 2 * PARTS].all()
    assert cells[2 * PARTS :, PARTS - 1 : PARTS + 1].all()
    border = 4 * 3 * PARTS - 4
    assert cells.sum() == border + 2 * (2 * PARTS) - 2  # one of the walls ends in the border


def test_markers_show_the_scene_and_replace_each_other(written):
    trials, found, size = written
    for (_, _, array), row in zip(found["/scene"], range(STEPS + 1), strict=False):
        first, *markers = array.markers
        assert first.action == DELETE_ALL
        assert len({marker.id for marker in markers}) == len(markers)
        said = [marker.text for marker in markers if marker.type == TEXT]
        assert said == ["HELLO!"] * (row % 2)
        [robot] = [marker for marker in markers if marker.ns == "robot"]
        assert robot.pose.position.y / size == pytest.approx(ROWS - trials[0].steps["robot_row"][row] - 0.5)
        [desired] = [marker for marker in markers if marker.ns == "desired"]
        start, end = desired.points
        heading = trials[0].steps["desired_direction"][row] * math.pi / 4
        assert math.remainder(math.atan2(end.y - start.y, end.x - start.x) - heading, math.tau) == pytest.approx(
            0, abs=1e-6
        )
    _, _, lab = found["/lab"][0]
    names = {marker.text: marker.pose.position for marker in lab.markers if marker.type == TEXT}
    assert (names["Room 0"].x, names["Room 0"].y) == (4 * size, 23 * size)  # in the north-west


@pytest.mark.parametrize("task", ["navigation", "go_to_human", "social"])
def test_each_task_has_what_it_has(tmp_path, task):
    write_ros2bag(tmp_path / "bag", [shown(task)])
    found = read(tmp_path / "bag")
    assert ("/human/pose" in found) == (task != "navigation")
    assert all(np.isfinite(message.pose.position.x) for _, _, message in found["/robot/pose"])


def test_nothing_is_overwritten_and_a_failure_leaves_nothing(tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "file").touch()
    with pytest.raises(UsageError, match=r"bag: exists; choose another folder with -o$"):
        write_ros2bag(tmp_path / "bag", [shown("visit")])
    with pytest.raises(RunError, match=r"can't be written: [^\n]+$"):
        write_ros2bag(tmp_path / "file" / "bag", [shown("visit")])

    def fails():
        yield shown("visit")
        raise RunError("the second is damaged")

    with pytest.raises(RunError, match="second"):
        write_ros2bag(tmp_path / "other", fails())
    assert {path.name for path in tmp_path.iterdir()} == {"bag", "file"}


def test_without_the_library_it_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rosbags.rosbag2", None)
    with pytest.raises(UsageError, match=r'pip install "visitlab\[ros2\]"$'):
        write_ros2bag(tmp_path / "bag", [shown("visit")])


def test_the_command(tiny_run, tmp_path):
    done = visitlab("export", tiny_run, "--ros2bag", "--trial", 1, "--cell-size", 2, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    name = "visit-fast-seed-0000-trial-1.ros2bag"
    assert done.stdout == f"visit/fast/seed-0000, trial 1: {name}\n"
    [(_, _, grid)] = read(tmp_path / name)["/map"]
    assert grid.info.resolution == pytest.approx(2 / PARTS)
    for size in (0, -1, "nan", "inf", "1e300"):
        done = visitlab("export", tiny_run, "--ros2bag", "--cell-size", size, cwd=tmp_path)
        assert (done.returncode, done.stderr.count("\n")) == (2, 1)
        assert "'--cell-size'" in done.stderr
