"""Trials as a ROS 2 bag (MCAP), for robots and for RViz.

| topic | message | when |
|---|---|---|
| `/robot/pose`, `/human/pose` | `geometry_msgs/PoseStamped` | each step |
| `/map` | `nav_msgs/OccupancyGrid`: walls and borders | once a trial, kept for who comes late |
| `/lab` | `visualization_msgs/MarkerArray`: floor, rooms with their names | once a trial, kept likewise |
| `/scene` | `visualization_msgs/MarkerArray`: robot, human, goal, desired direction, what is said | each step |

Frames, units and axes are those of `ros2_messages.py`. A step takes a second of simulated time, from 0; the trials
follow each other.
"""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Literal, NamedTuple

from visitlab_cli.errors import UsageError
from visitlab_cli.export.ros2_markers import marker_array
from visitlab_cli.export.ros2_messages import STEP_NS, Messages
from visitlab_cli.scene.scene import BODIES, Scene
from visitlab_cli.scene.trial import Trial
from visitlab_cli.whole_file import new_folder

MISSING = 'a ROS 2 bag needs the library rosbags: pip install "visitlab[ros2]"'
POSE, GRID, MARKERS = (
    "geometry_msgs/msg/PoseStamped",
    "nav_msgs/msg/OccupancyGrid",
    "visualization_msgs/msg/MarkerArray",
)
TOPICS = {"/robot/pose": POSE, "/human/pose": POSE, "/map": GRID, "/lab": MARKERS, "/scene": MARKERS}
_KEPT = ("/map", "/lab")
_BAG_VERSION: Literal[8] = 8
"""What ROS 2 Humble, of 2022, reads as well as its successors."""
_FOR_EVER = (9223372036, 854775807)
"""Seconds and nanoseconds by which ROS 2 says that there is no limit: its longest duration, 2**63 - 1 ns."""
_RECENT = 10
"""Messages that a subscriber may lag behind."""


class _Sent(NamedTuple):
    topic: str
    message: Any


def write_ros2bag(path: Path, trials: Iterable[Trial], cell_size: float = 1.0) -> int:
    """Write trials, one after the other, to a new bag, a folder; returns the number of rows written.

    Raises:
        UsageError: `path` exists, or rosbags is not installed.
        RunError: it cannot be written.
    """
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError as error:
        raise UsageError(MISSING) from error
    store = get_typestore(Stores.ROS2_HUMBLE)
    rows = 0
    with (
        new_folder(path) as folder,
        Writer(folder, version=_BAG_VERSION, storage_plugin=StoragePlugin.MCAP) as writer,
    ):
        channels: dict[str, Any] = {}
        for trial in trials:
            scene, messages = Scene(trial), Messages(store, trial, cell_size)
            for step in range(trial.length):
                messages.time = rows * STEP_NS
                for topic, message in _sent(messages, scene, step):
                    kind = TOPICS[topic]
                    if topic not in channels:
                        channels[topic] = writer.add_connection(
                            topic, kind, typestore=store, offered_qos_profiles=[_qos(topic in _KEPT)]
                        )
                    writer.write(channels[topic], messages.time, store.serialize_cdr(message, kind))
                rows += 1
    return rows


def _sent(messages: Messages, scene: Scene, step: int) -> Iterator[_Sent]:
    """What is sent for a step of a trial."""
    if step == 0:
        yield _Sent("/map", messages.grid())
        yield _Sent("/lab", marker_array(messages, scene.place()))
    for who in BODIES:
        if f"{who}_row" in scene.trial.steps:
            yield _Sent(f"/{who}/pose", messages.pose_of(who, step))
    yield _Sent("/scene", marker_array(messages, scene.moment(step)))


def _qos(kept: bool) -> Any:
    """Reliable; where `kept`, who subscribes later gets the last message, too."""
    from rosbags.interfaces import Qos, QosDurability, QosHistory, QosLiveliness, QosReliability, QosTime

    ever = QosTime(*_FOR_EVER)
    return Qos(
        QosHistory.KEEP_LAST,
        1 if kept else _RECENT,
        QosReliability.RELIABLE,
        QosDurability.TRANSIENT_LOCAL if kept else QosDurability.VOLATILE,
        ever,
        ever,
        QosLiveliness.AUTOMATIC,
        ever,
        False,
    )
