"""An open log: what it says of itself, where its chunks are, and each of them as arrays.

A chunk whose bytes are laid out exactly as this package lays them out is one view on them; any other is decoded message
by message. Chunks of a file that does not use them are runs of messages.
"""

import contextlib
import shlex
from collections.abc import Iterator
from functools import cached_property, lru_cache
from itertools import islice
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
import numpy.typing as npt
from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.log.attachments import attached
from visitlab_cli.log.chunks import chunk_at, chunk_content, content_size
from visitlab_cli.log.decoding import Decoded, RefusedError, TaskGuess, as_records, impossible
from visitlab_cli.log.definitions import Definitions
from visitlab_cli.log.foreign import decode
from visitlab_cli.log.layout import STEP_CHANNEL, TRIAL_CHANNEL, Layout, Records, layout_of
from visitlab_cli.log.mcap_file import INDEX_ENTRY, INDEX_HEAD
from visitlab_cli.log.schema import (
    FORMAT,
    METADATA_NAME,
    ONE_TRIAL_IN,
    STEP,
    STEP_TOPIC,
    TRIAL,
    TRIAL_TOPIC,
)
from visitlab_cli.log.source import (
    MAX_RECORD,
    PREFIX,
    DamagedError,
    McapSource,
    NotMcapError,
    Place,
    has_data_crc,
    walk,
)
from visitlab_cli.world.tasks import TASK_NAMES, VISIT

RUN_OF_MESSAGES = 1 << 20
"""About how many bytes of messages outside of chunks are read at a time."""
MESSAGES_AT_ONCE = 1 << 14
"""So many messages of another layout are in memory at a time."""
CHUNKS_KEPT = 2
MOST_NUMBER = 10**9 - 1
"""No trial and no step has a larger number."""
TASK, CELL = "task", "cell"


class Block(NamedTuple):
    """The messages of a chunk, or of a part of it."""

    steps: Records
    trials: Records


class Log:
    """A log of visitlab.

    `attributes` are the cell's metadata; of a log of another writer as much as its messages tell. `has_steps`,
    `has_trials`: it has a topic of these, so far as it was read, where chunks define the topics.

    Raises:
        NotMcapError: the file is of another kind.
        DamagedError: the file is not whole, or no log of steps.
        RefusedError: its messages are none that a log of visitlab has.
    """

    def __init__(self, file: BinaryIO):
        self._source = McapSource(file)
        self._all = Definitions()  # the first of each
        self._latest: dict[tuple[bool, int], Schema | Channel] = {}
        self._parts: list[Place | Schema | Channel] = []
        self._indexes: dict[int, list[Place]] = {}  # by the number of the part that they follow
        self._attachments: list[Place] = []
        self._data_ends: list[Place] = []
        attributes: dict[str, str] | None = None
        for place in walk(self._source):
            if place.opcode == Opcode.CHUNK:
                self._parts.append(place)
            elif place.opcode == Opcode.MESSAGE:
                self._add_loose(place)
            elif place.opcode == Opcode.MESSAGE_INDEX:
                self._indexes.setdefault(len(self._parts) - 1, []).append(place)
            elif place.opcode == Opcode.ATTACHMENT:
                self._attachments.append(place)
            elif place.opcode == Opcode.METADATA:
                metadata = self._source.parse(Metadata, place)
                attributes = metadata.metadata if metadata.name == METADATA_NAME else attributes
            elif place.opcode == Opcode.DATA_END:
                self._data_ends.append(place)
            elif place.opcode in (Opcode.SCHEMA, Opcode.CHANNEL):
                self._define(self._source.definition(place))
        self.has_steps, self.has_trials = map(self._all.has_topic, (STEP_TOPIC, TRIAL_TOPIC))
        self.attributes = self._checked(attributes) if attributes is not None else self._guessed()
        task, parts = self.attributes[TASK], self._all.parts
        self.step_layout, self.trial_layout = layout_of(STEP, task, parts), layout_of(TRIAL, task, parts)
        self.own_block = lru_cache(CHUNKS_KEPT)(self._own_block)

    def _define(self, definition: Schema | Channel) -> None:
        """Note a definition where it is; for what comes before it, it only counts where there is no other."""
        key = isinstance(definition, Schema), definition.id
        if self._latest.get(key) != definition:
            self._parts.append(definition)
        if key not in self._latest:
            self._all.learn(definition)
        self._latest[key] = definition

    def attachment(self, name: str) -> bytes | None:
        """The first attachment of a name.

        Raises:
            DamagedError: it is damaged.
        """
        for place in self._attachments:
            found = attached(self._source, place)
            if found.name == name and found.end - found.start > MAX_RECORD:
                raise DamagedError(f"its {name} is larger than {MAX_RECORD:,} bytes")
            if found.name == name:
                return self._source.read(found.start, found.end)
        return None

    def blocks(self, *, checked: bool = True) -> Iterator[Block]:
        """The blocks of all chunks, in the order of the file; `checked`: every byte, as far as CRCs cover it.

        Raises:
            DamagedError: a byte of the file is wrong, anywhere, as far as its CRCs tell.
            RefusedError: a message is none that a log of visitlab has.
        """
        if checked:
            if not self._data_ends:
                raise DamagedError("its data has no end")
            if not all(has_data_crc(self._source, place) for place in self._data_ends):
                raise DamagedError("its checksum is wrong")
        for content, definitions in self._contents():
            own = self._viewed(content) if definitions.are_ours else None
            yield from [own] if own is not None else self._decoded(content, definitions)

    def _contents(self) -> Iterator[tuple[bytes, Definitions]]:
        """What the chunks hold, each with the definitions before it."""
        definitions = Definitions(self._all)
        for part in self._parts:
            if isinstance(part, Place):
                yield self._content(part), definitions
                self.has_steps = self.has_steps or definitions.has_topic(STEP_TOPIC)
                self.has_trials = self.has_trials or definitions.has_topic(TRIAL_TOPIC)
            else:
                definitions.learn(part)

    @cached_property
    def own_chunks(self) -> list[tuple[Place, int]]:
        """The chunks of a log that is ours, each with the number of steps before it; empty where it is not.

        By its definitions and indexes: each chunk holds messages of our channels, and nothing else.
        """
        chunks: list[tuple[Place, int]] = []
        definitions, steps = Definitions(self._all), 0
        for number, part in enumerate(self._parts):
            if not isinstance(part, Place):
                if chunks:
                    return []
                definitions.learn(part)
                continue
            counts = {STEP_CHANNEL: 0, TRIAL_CHANNEL: 0}
            for index in self._indexes.get(number, []):
                head = self._source.read(index.start + PREFIX.size, index.start + PREFIX.size + INDEX_HEAD.size)
                channel, size = INDEX_HEAD.unpack(head.ljust(INDEX_HEAD.size))
                counts[channel] = counts.get(channel, 0) + size // INDEX_ENTRY.itemsize
            size = counts[STEP_CHANNEL] * self.step_layout.dtype.itemsize
            size += counts[TRIAL_CHANNEL] * self.trial_layout.dtype.itemsize
            is_chunk = part.opcode == Opcode.CHUNK and size == content_size(self._source, part)
            if not is_chunk or not definitions.are_ours or counts.keys() != {STEP_CHANNEL, TRIAL_CHANNEL}:
                return []
            chunks.append((part, steps))
            steps += counts[STEP_CHANNEL]
        return chunks

    def _own_block(self, chunk: int) -> Block | None:
        """One of `own_chunks`, None where its bytes, or the order of its steps, are not ours after all."""
        place, steps_before = self.own_chunks[chunk]
        block = self._viewed(self._content(place))
        return None if block is None or (block.steps["sequence"][:1] < steps_before).any() else block

    def _content(self, place: Place) -> bytes:
        if place.opcode == Opcode.CHUNK:
            return chunk_content(chunk_at(self._source, place), place)
        return self._source.read(place.start, place.end)

    def _viewed(self, content: bytes) -> Block | None:
        """The steps and then the trials as views, None where the bytes are laid out in another way."""
        steps = np.frombuffer(content, self.step_layout.dtype, count=len(content) // self.step_layout.dtype.itemsize)
        steps = steps[: _leading(self.step_layout.matches(steps))]
        rest = content[steps.nbytes :]
        trials = np.frombuffer(rest, self.trial_layout.dtype, count=len(rest) // self.trial_layout.dtype.itemsize)
        if trials.nbytes != len(rest) or not self.trial_layout.matches(trials).all():
            return None
        return _possible(Block(steps, trials))

    def _decoded(self, content: bytes, definitions: Definitions) -> Iterator[Block]:
        messages = decode(content, definitions)
        while some := list(islice(messages, MESSAGES_AT_ONCE)):
            yield _block_of(some, self.step_layout, self.trial_layout)

    def _add_loose(self, place: Place) -> None:
        """Note a message outside of chunks, as part of a run of such messages."""
        last = self._parts[-1] if self._parts else None
        joins = isinstance(last, Place) and (last.opcode, last.end) == (Opcode.MESSAGE, place.start)
        if isinstance(last, Place) and joins and last.end - last.start < RUN_OF_MESSAGES:
            self._parts[-1] = Place(Opcode.MESSAGE, last.start, place.end)
        else:
            self._parts.append(place)

    def _checked(self, attributes: dict[str, str]) -> dict[str, str]:
        if attributes.get(TASK) not in TASK_NAMES:
            raise DamagedError("its metadata names no task")
        return attributes

    def _guessed(self) -> dict[str, str]:
        """The attributes of a log without metadata, from its steps: all are looked at, the last may tell."""
        guess: TaskGuess | None = None
        for content, definitions in self._contents():
            for each in decode(content, definitions):
                if each.kind.topic == STEP_TOPIC:
                    guess = guess or TaskGuess()
                    guess.see(each.message)
            if guess is not None and guess.is_sure:
                break
        if guess is None:
            raise NotMcapError("not a log of visitlab")
        return {"format": FORMAT, TASK: guess.task, CELL: "", ONE_TRIAL_IN: "1"}


@contextlib.contextmanager
def open_log(path: Path) -> Iterator[Log]:
    """The log at `path`, with whatever is wrong with it shown as one line.

    Raises:
        NotFoundError: there is no such file.
        RunError: it cannot be read, is no log of visitlab, or damaged.
    """
    try:
        if path.exists() and not path.is_file():
            raise RunError(f"{path}: cannot read the log: is no file")
        with path.open("rb") as file:
            yield Log(file)
    except FileNotFoundError as error:
        raise NotFoundError(f"{path}: no such file") from error
    except OSError as error:
        raise RunError(f"{path}: cannot read the log: {error.strerror}") from error
    except (NotMcapError, RefusedError) as error:
        raise RunError(f"{path}: {error}") from error
    except DamagedError as error:
        mending = f"visitlab recover {shlex.quote(str(path))}"
        raise RunError(f"{path}: not a whole MCAP file: {error}; {mending} saves what is whole") from error


def readable(content: bytes, definitions: Definitions) -> bool:
    """Whether the messages in `content`, the records of a chunk, can be read; what it defines is learnt."""
    steps, trials = layout_of(STEP, VISIT), layout_of(TRIAL, VISIT)
    try:
        messages = decode(content, definitions)
        while some := list(islice(messages, MESSAGES_AT_ONCE)):
            _block_of(some, steps, trials)
    except (DamagedError, RefusedError):
        return False
    return True


def _block_of(messages: list[Decoded], steps: Layout, trials: Layout) -> Block:
    own = [[each for each in messages if each.kind.topic == topic] for topic in (STEP_TOPIC, TRIAL_TOPIC)]
    return _possible(Block(as_records(own[0], steps), as_records(own[1], trials)))


def _possible(block: Block) -> Block:
    """A block, if the numbers of its trials and steps can be such.

    Raises:
        RefusedError: one cannot.
    """
    for records, message, names in ((block.steps, STEP, ("trial", "step")), (block.trials, TRIAL, ("trial", "steps"))):
        for name in names:
            if len(records) and records[name].max() > MOST_NUMBER:
                row = records[int(records[name].argmax())]
                raise impossible(message, row[names[0]], row[names[1]], name, row[name])
    return block


def _leading(flags: npt.NDArray[np.bool_]) -> int:
    """How many of the `flags` are set before the first that is not."""
    return len(flags) if flags.all() else int(flags.argmin())
