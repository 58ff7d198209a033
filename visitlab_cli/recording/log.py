"""An open log: what it says of itself, where its chunks are, and each of them as arrays.

A chunk that this package wrote is one view on its bytes, the constant bytes checked; any other is decoded message
by message. Chunks of a file that does not use them are runs of messages.
"""

import contextlib
import shlex
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode
from mcap.records import Channel, Chunk, Metadata, Schema

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.recording.foreign import Definitions, as_records, decode, task_of
from visitlab_cli.recording.layout import STEP_CHANNEL, TRIAL_CHANNEL, Records, layout_of
from visitlab_cli.recording.schema import (
    FORMAT,
    METADATA_NAME,
    ONE_TRIAL_IN,
    STEP,
    STEP_TOPIC,
    TRIAL,
    TRIAL_TOPIC,
)
from visitlab_cli.recording.source import (
    DamagedError,
    McapSource,
    NotMcapError,
    Place,
    chunk_content,
    has_data_crc,
    walk,
)
from visitlab_cli.world.tasks import TASK_NAMES

RUN_OF_MESSAGES = 1 << 20
"""About how many bytes of messages outside of chunks are read at a time."""
CHUNKS_KEPT = 4
TASK, CELL = "task", "cell"


class Block(NamedTuple):
    """The messages of one chunk."""

    steps: Records
    trials: Records


class Log:
    """A log of visitlab.

    `attributes` are the cell's metadata; of a log of another writer as much as its messages tell. `is_ours`: its
    layout is ours, and so are its trials in their order.

    Raises:
        NotMcapError: the file is of another kind.
        DamagedError: the file is not whole, or no log of steps.
    """

    def __init__(self, file: BinaryIO):
        self._source = McapSource(file)
        self._definitions = Definitions()
        self._data_end: Place | None = None
        self.chunks: list[Place] = []
        attributes: dict[str, str] | None = None
        for place in walk(self._source):
            if place.opcode == Opcode.CHUNK:
                self.chunks.append(place)
            elif place.opcode == Opcode.MESSAGE:
                self._add_loose(place)
            elif place.opcode == Opcode.METADATA:
                metadata = self._source.parse(Metadata, place)
                attributes = metadata.metadata if metadata.name == METADATA_NAME else attributes
            elif place.opcode == Opcode.DATA_END:
                self._data_end = place
            elif place.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                kind = Schema if place.opcode == Opcode.SCHEMA else Channel
                self._definitions.learn(self._source.parse(kind, place))
        self.attributes = self._checked(attributes) if attributes is not None else self._guessed()
        task = self.attributes[TASK]
        self.step_layout, self.trial_layout = layout_of(STEP, task), layout_of(TRIAL, task)
        self.is_ours = self._is_ours()
        self.block = lru_cache(CHUNKS_KEPT)(self._block)

    @property
    def has_trials(self) -> bool:
        """Whether the log has a topic of trials; so far as it was read, where chunks define the topics."""
        return self._definitions.channel_of(TRIAL_TOPIC) is not None

    def blocks(self) -> Iterator[Block]:
        """The blocks of all chunks, in the order of the file.

        Raises:
            DamagedError: a byte of the file is wrong, anywhere, as far as its CRCs tell.
        """
        if self._data_end is None or not has_data_crc(self._source, self._data_end):
            raise DamagedError("its checksum is wrong")
        for chunk in range(len(self.chunks)):
            yield self._block(chunk)

    def _block(self, chunk: int) -> Block:
        content = self._content(self.chunks[chunk])
        return (self._viewed(content) if self.is_ours else None) or self._decoded(content)

    def _content(self, place: Place) -> bytes:
        if place.opcode == Opcode.CHUNK:
            return chunk_content(self._source.parse(Chunk, place), place)
        return self._source.read(place.start, place.end)

    def _viewed(self, content: bytes) -> Block | None:
        """The steps and then the trials as views, None where the bytes are laid out in another way."""
        steps = np.frombuffer(content, self.step_layout.dtype, count=len(content) // self.step_layout.dtype.itemsize)
        steps = steps[: _leading(self.step_layout.matches(steps))]
        rest = content[steps.nbytes :]
        trials = np.frombuffer(rest, self.trial_layout.dtype, count=len(rest) // self.trial_layout.dtype.itemsize)
        if trials.nbytes != len(rest) or not self.trial_layout.matches(trials).all():
            return None
        return Block(steps, trials)

    def _decoded(self, content: bytes) -> Block:
        found = decode(content, self._definitions)
        return Block(as_records(found[STEP_TOPIC], self.step_layout), as_records(found[TRIAL_TOPIC], self.trial_layout))

    def _add_loose(self, place: Place) -> None:
        """Note a message outside of chunks, as part of a run of such messages."""
        last = self.chunks[-1] if self.chunks else None
        joins = last is not None and last.opcode == Opcode.MESSAGE and last.end == place.start
        if last is not None and joins and last.end - last.start < RUN_OF_MESSAGES:
            self.chunks[-1] = Place(Opcode.MESSAGE, last.start, place.end)
        else:
            self.chunks.append(place)

    def _checked(self, attributes: dict[str, str]) -> dict[str, str]:
        if attributes.get(TASK) not in TASK_NAMES:
            raise DamagedError("its metadata names no task")
        return attributes

    def _guessed(self) -> dict[str, str]:
        """The attributes of a log without metadata, from its first block with steps."""
        for place in self.chunks:
            messages = [each.message for each in decode(self._content(place), self._definitions)[STEP_TOPIC]]
            if messages:
                return {"format": FORMAT, TASK: task_of(messages), CELL: "", ONE_TRIAL_IN: "1"}
        raise NotMcapError("not a log of visitlab")

    def _is_ours(self) -> bool:
        wanted = ((STEP_TOPIC, STEP, STEP_CHANNEL), (TRIAL_TOPIC, TRIAL, TRIAL_CHANNEL))
        channels = [(self._definitions.channel_of(topic), message, number) for topic, message, number in wanted]
        return all(
            channel is not None and channel.id == number and self._definitions.are_ours(message, channel)
            for channel, message, number in channels
        )


@contextlib.contextmanager
def open_log(path: Path) -> Iterator[Log]:
    """The log at `path`, with whatever is wrong with it shown as one line.

    Raises:
        NotFoundError: there is no such file.
        RunError: it cannot be read, is no log of visitlab, or damaged.
    """
    try:
        with path.open("rb") as file:
            yield Log(file)
    except FileNotFoundError as error:
        raise NotFoundError(f"{path}: no such file") from error
    except OSError as error:
        raise RunError(f"{path}: cannot read the log: {error.strerror}") from error
    except NotMcapError as error:
        raise RunError(f"{path}: {error}") from error
    except DamagedError as error:
        mending = f"visitlab recover {shlex.quote(str(path))}"
        raise RunError(f"{path}: not a whole MCAP file: {error}; {mending} saves what is whole") from error


def _leading(flags: npt.NDArray[np.bool_]) -> int:
    """How many of the `flags` are set before the first that is not."""
    return len(flags) if flags.all() else int(flags.argmin())
