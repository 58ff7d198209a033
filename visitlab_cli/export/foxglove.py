"""Trials as an MCAP file that Foxglove shows without a plug-in.

| topic | schema | panel |
|---|---|---|
| `/tf` | `foxglove.FrameTransforms`: robot and human in the frame `lab` | 3D |
| `/lab` | `foxglove.SceneUpdate`: floor and rooms, once a trial | 3D |
| `/scene` | `foxglove.SceneUpdate`: robot, human, goal room, desired direction, what is said | 3D |
| `/caption` | `foxglove.Log`: what happens, in words | Log |
| `/step` | `visitlab.Step`, as in the log: every number and named state | Plot, State Transitions, Raw Messages |

Time is that of the log, one second a step, from 0; the trials follow each other.
"""

from collections.abc import Iterable, Iterator
from functools import cache
from itertools import chain, islice
from pathlib import Path
from typing import Any, NamedTuple

from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.json_format import ParseDict
from google.protobuf.message_factory import GetMessageClass
from google.protobuf.timestamp_pb2 import Timestamp
from mcap.well_known import MessageEncoding, SchemaEncoding
from mcap.writer import Writer

from visitlab_cli.export import foxglove_schema
from visitlab_cli.export.foxglove_scene import Fields, lab_entities, scene_entities, transforms
from visitlab_cli.export.foxglove_schema import FRAME_TRANSFORMS, LOG, SCENE_UPDATE, message_class
from visitlab_cli.log import schema
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import caption
from visitlab_cli.whole_file import new_file
from visitlab_cli.world.columns import SOME_CELLS

TF, LAB, SCENE, CAPTION = "/tf", "/lab", "/scene", "/caption"
SCHEMAS = {TF: FRAME_TRANSFORMS, LAB: SCENE_UPDATE, SCENE: SCENE_UPDATE, CAPTION: LOG}
NAME = "visitlab"


class _Sent(NamedTuple):
    topic: str
    message: Any


def write_foxglove(path: Path, trials: Iterable[Trial]) -> int:
    """Write trials, one after the other, to a new file; returns the number of rows written.

    Raises:
        UsageError: `path` exists.
        RunError: it cannot be written.
    """
    rows = 0
    several = iter(trials)
    first = [*islice(several, 1)]
    with new_file(path) as beside, beside.open("wb") as file:
        writer = Writer(file)
        writer.start(library=NAME)
        channels = _channels(writer, schema.parts_in(first[0].steps) if first else ())
        for trial in chain(first, several):
            scene = Scene(trial)
            for step in range(trial.length):
                time = rows * schema.STEP_NS
                for topic, message in _messages(scene, step, time):
                    writer.add_message(channels[topic], time, message.SerializeToString(), time, rows)
                rows += 1
        writer.finish()  # type: ignore[no-untyped-call]  # mcap leaves it unannotated
    return rows


def _channels(writer: Writer, parts: schema.Parts) -> dict[str, int]:
    """The channel of each topic, for trials of a log with these parts."""
    content = foxglove_schema.schema_bytes()
    described = {topic: (f"{foxglove_schema.PACKAGE}.{name}", content) for topic, name in SCHEMAS.items()}
    described[schema.STEP_TOPIC] = (f"{schema.PACKAGE}.{schema.STEP}", schema.schema_bytes(parts))
    return {
        topic: writer.register_channel(
            topic, MessageEncoding.Protobuf, writer.register_schema(name, SchemaEncoding.Protobuf, data)
        )
        for topic, (name, data) in described.items()
    }


def _messages(scene: Scene, step: int, time: int) -> Iterator[_Sent]:
    """What is sent for a step of a trial."""
    now = {"timestamp": Timestamp(seconds=time // schema.STEP_NS).ToJsonString()}
    steps = scene.trial.steps
    moved = [now | transform for transform in transforms(scene, step)]
    yield _Sent(TF, _made(FRAME_TRANSFORMS, {"transforms": moved}))
    if step == 0:
        yield _Sent(LAB, _made(SCENE_UPDATE, {"entities": [now | each for each in lab_entities(scene)]}))
    yield _Sent(SCENE, _made(SCENE_UPDATE, {"entities": [now | each for each in scene_entities(scene, step)]}))
    words = f"trial {scene.trial.number}, step {steps['step'][step]}: {caption(steps, step, scene.trial.lab)}"
    yield _Sent(CAPTION, _made(LOG, now | {"level": "INFO", "message": words, "name": NAME}))
    values = {name: column[step].item() for name, column in steps.items()}
    yield _Sent(schema.STEP_TOPIC, _step_class()(**values))


def _made(name: str, fields: Fields) -> Any:
    return ParseDict(fields, message_class(name)())


@cache
def _step_class() -> Any:
    pool = DescriptorPool()
    pool.Add(schema.file_descriptor(SOME_CELLS))
    return GetMessageClass(pool.FindMessageTypeByName(f"{schema.PACKAGE}.{schema.STEP}"))
