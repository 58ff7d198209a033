"""Logs that were cut, joined, or written by other programs; and logs that claim more than they hold."""

import io
import json
import re
import struct
from collections.abc import Callable, Iterator
from pathlib import Path

from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.opcode import Opcode
from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from tests.faults.bench import Done
from tests.faults.fault import Try, fault

MAGIC = b"\x89MCAP0\r\n"
PREFIX = struct.Struct("<BQ")
MEMORY = 600 << 20
SOON = 15.0
SUMMARY = {Opcode.CHUNK_INDEX, Opcode.ATTACHMENT_INDEX, Opcode.METADATA_INDEX, Opcode.STATISTICS, Opcode.SUMMARY_OFFSET}


def log(this: Try, task: str = "social/mb/fast") -> Path:
    """A whole log of the undisturbed run."""
    return this.bench.whole / task / "seed-0000" / "steps.mcap"


Record = tuple[int, bytes]


def records(data: bytes) -> Iterator[Record]:
    """Opcode and body of every record of a whole log."""
    position = len(MAGIC)
    while position < len(data) - len(MAGIC):
        opcode, length = PREFIX.unpack_from(data, position)
        yield opcode, data[position + PREFIX.size : position + PREFIX.size + length]
        position += PREFIX.size + length


def file_of(chosen: list[Record]) -> bytes:
    """A log of these records, without a summary, which is whole by the specification."""
    data = [each for each in chosen if each[0] not in SUMMARY and each[0] not in (Opcode.DATA_END, Opcode.FOOTER)]
    seen: set[int] = set()
    ended = False
    body = []
    for opcode, content in data:  # the summary repeats schemas and channels behind the data
        ended = ended or (
            opcode in (Opcode.SCHEMA, Opcode.CHANNEL)
            and opcode in seen
            and any(each[0] == Opcode.CHUNK for each in body)
        )
        if not ended:
            body.append((opcode, content))
            seen.add(opcode)
    body += [(Opcode.DATA_END, bytes(4)), (Opcode.FOOTER, bytes(20))]
    return MAGIC + b"".join(PREFIX.pack(opcode, len(content)) + content for opcode, content in body) + MAGIC


def with_records_between(this: Try, data: bytes, opcodes: range) -> bytes:
    """Records of opcodes that no reader knows, which the specification lets anybody write, among the others."""
    mixed: list[Record] = []
    for record in records(data):
        mixed += [record, (this.random.choice(opcodes), this.random.randbytes(this.random.randrange(60)))]
    return file_of(mixed)


def padded(this: Try, data: bytes) -> bytes:
    """Bytes behind the known fields of records, which the specification tells readers to ignore."""
    may = {Opcode.HEADER, Opcode.METADATA, Opcode.CHUNK, Opcode.MESSAGE_INDEX, Opcode.SCHEMA, Opcode.CHANNEL}
    return file_of(
        [(code, body + bytes(this.random.randrange(1, 9)) if code in may else body) for code, body in records(data)]
    )


def rewritten(this: Try, data: bytes, renumbered: bool = False, **options: object) -> bytes:
    """The same log by the MCAP library's own writer; `renumbered`: half of the steps by another schema."""
    target = io.BytesIO()
    writer = Writer(target, **options)  # type: ignore[arg-type]
    writer.start()
    reader = make_reader(io.BytesIO(data))
    for metadata in reader.iter_metadata():
        writer.add_metadata(metadata.name, metadata.metadata)
    channels: dict[int, tuple[int, Callable[[bytes, int], bytes]]] = {}
    others: dict[int, int] = {}
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        assert schema is not None
        if channel.id not in channels:
            ours = writer.register_schema(schema.name, schema.encoding, schema.data)
            channels[channel.id] = writer.register_channel(channel.topic, "protobuf", ours, channel.metadata), _as_it_is
            if renumbered and channel.topic == "/step":
                text, translate = _renumbered(schema.data)
                theirs = writer.register_schema(schema.name, schema.encoding, text)
                others[channel.id] = writer.register_channel(channel.topic, "protobuf", theirs)
                channels[channel.id] = channels[channel.id][0], translate
        place, translate = channels[channel.id]
        second = channel.id in others and message.log_time // 10**9 // 100 % 2 == 1
        content = translate(message.data, 1) if second else message.data
        writer.add_message(
            others[channel.id] if second else place, message.log_time, content, message.publish_time, message.sequence
        )
    writer.finish()
    return target.getvalue()


def _as_it_is(data: bytes, way: int) -> bytes:
    return data


def _renumbered(schema: bytes) -> tuple[bytes, Callable[[bytes, int], bytes]]:
    """A schema with the same fields by other numbers, and what writes a message so."""
    classes = []
    files = FileDescriptorSet.FromString(schema)
    for shift in (0, 40):
        for message in files.file[0].message_type:
            for field in message.field:
                field.number += shift
        pool = DescriptorPool()
        pool.Add(files.file[0])
        classes.append(GetMessageClass(pool.FindMessageTypeByName("visitlab.Step")))

    def translate(data: bytes, way: int) -> bytes:
        before = classes[0].FromString(data)
        return classes[1](
            **{field.name: value for field, value in before.ListFields()} | _zeros(before)
        ).SerializeToString()

    return files.SerializeToString(), translate


def _zeros(message: object) -> dict[str, object]:
    return {
        field.name: getattr(message, field.name) for field in message.DESCRIPTOR.fields if message.HasField(field.name)
    }  # type: ignore[attr-defined]


FOREIGN: dict[str, Callable[[Try, bytes], bytes]] = {
    "private records": lambda this, data: with_records_between(this, data, range(0x80, 0x100)),
    "future records": lambda this, data: with_records_between(this, data, range(0x20, 0x80)),
    "padding": padded,
    "no summary": lambda this, data: file_of(list(records(data))),
    "no chunks": lambda this, data: rewritten(this, data, use_chunking=False),
    "private records, no chunks": lambda this, data: with_records_between(
        this, rewritten(this, data, use_chunking=False), range(0x80, 0x100)
    ),
    "lz4": lambda this, data: rewritten(this, data, compression=CompressionType.LZ4),
    "no compression": lambda this, data: rewritten(this, data, compression=CompressionType.NONE, chunk_size=1000),
    "no CRCs": lambda this, data: rewritten(this, data, enable_crcs=False, use_statistics=False),
    "two schemas": lambda this, data: rewritten(this, data, renumbered=True),
    "two schemas, no chunks": lambda this, data: rewritten(this, data, renumbered=True, use_chunking=False),
}


def table(done: Done) -> str:
    """What `steps --json` printed, without the file's name."""
    try:
        return json.dumps(json.loads(done.stdout) | {"cell": ""})
    except (ValueError, TypeError):
        return done.stdout


@fault(
    "foreign-logs",
    "logs by other writers: private records, padding, two schemas, no chunks, no summary",
    2 * len(FOREIGN),
    2,
)
def foreign_logs(this: Try) -> None:
    name = list(FOREIGN)[this.index % len(FOREIGN)]
    original = log(this, this.random.choice(["social/mb/fast", "visit/fast", "navigation/mf"]))
    other, fixed = this.folder / "other.mcap", this.folder / "fixed.mcap"
    other.write_bytes(FOREIGN[name](this, original.read_bytes()))
    trial = this.random.randrange(150)
    expected = this.visitlab("steps", original, "--trial", trial, "--json")
    found = this.visitlab("steps", other, "--trial", trial, "--json")
    if this.told(found, 0) and table(found) != table(expected):
        this.wrong.append(f"{name}: other steps than the original's")
    saved = this.visitlab("recover", other, "-o", fixed, "--json")
    if this.told(saved, 0):
        whole = json.loads(this.visitlab("recover", original, "-o", this.folder / "copy.mcap", "--json").stdout)
        told = json.loads(saved.stdout)
        wanted = {key: whole[key] for key in ("steps", "trials", "parts_of_trials", "was_whole", "lost_bytes")}
        got = {key: told[key] for key in wanted}
        if got["steps"] < wanted["steps"]:
            this.lost.append(f"{name}: recover saved {got['steps']} of {wanted['steps']} steps")
        elif got != wanted:
            this.wrong.append(f"{name}: recover calls what is whole damaged: {got}")
        again = this.visitlab("steps", fixed, "--trial", trial, "--json")
        this.wrong += [f"{name}: other steps after recover"] * (table(again) != table(expected))


@fault("cut-logs", "a log cut at a random byte (a crash, a full disk): every whole chunk comes back", 10, 1)
def cut_logs(this: Try) -> None:
    original = log(this, "visit/fast" if this.index % 2 else "social/mb/fast")
    data = original.read_bytes()
    cut = this.random.randrange(len(data) // 10, len(data) - 1)
    broken, fixed = this.folder / "broken.mcap", this.folder / "fixed.mcap"
    broken.write_bytes(data[:cut])
    this.told(this.visitlab("steps", broken), 0, 4, names="visitlab recover")
    done = this.visitlab("recover", broken, "-o", fixed, "--json")
    position, expected = len(MAGIC), 0
    for opcode, body in records(data):
        position += PREFIX.size + len(body)
        if opcode == Opcode.CHUNK and position <= cut:
            expected += 1
    if expected == 0:
        this.told(done, 0, 4, names="nothing in it can be saved")
    elif this.told(done, 0):
        rows = sum(opcode == Opcode.CHUNK for opcode, _ in records(fixed.read_bytes()))
        if rows < expected:
            this.lost.append(f"recover saved {rows} of {expected} whole chunks")
    this.lost += ["the broken file was changed"] * (broken.read_bytes() != data[:cut])


ENDS: dict[str, tuple[Callable[[bytes], bytes], str]] = {
    "empty": (lambda data: b"", "empty|no log|nothing|not a log"),
    "five bytes": (lambda data: data[:5], "no log|nothing|short|not a log"),
    "a text": (lambda data: b"hello\n" * 9, "no log|nothing|not a log|MCAP"),
    "two joined": (lambda data: data + data, "second|another|joined|behind"),
    "ends in zeros": (lambda data: data[: len(data) // 2] + bytes(300_000_000), "zero|cut|recover|whole"),
    "ends in noise": (lambda data: data[:-20] + bytes(range(256)) * 1000, "cut|recover|whole"),
}


@fault("ends-of-logs", "empty, five bytes, two logs joined, 300 MB of zeros at the end: true words, soon", len(ENDS), 0)
def ends_of_logs(this: Try) -> None:
    name = list(ENDS)[this.index % len(ENDS)]
    change, words = ENDS[name]
    broken = this.folder / "broken.mcap"
    broken.write_bytes(change(log(this).read_bytes()))
    for command in (("steps", broken), ("recover", broken, "-o", this.folder / "fixed.mcap")):
        done = this.visitlab(*command)
        this.told(done, 0, 4)
        if not re.search(words, done.stdout + done.stderr) or "Invalid argument" in done.stderr:
            this.wrong.append(
                f"{name}: {done.words} does not say {words!r}: {(done.stdout + done.stderr).strip()[-200:]!r}"
            )
        this.wrong += [f"{name}: {done.words} took {done.seconds:.0f} s"] * (done.seconds > SOON)
        this.wrong += [f"{name}: {done.words} held {done.memory >> 20} MB"] * (done.memory > 2 * MEMORY)
    broken.unlink()


def bomb(this: Try, data: bytes, how: str, size: int) -> bytes:
    """A chunk that says it holds little and unpacks to a gigabyte, or says it holds a gigabyte."""
    import lz4.frame
    import zstandard

    zeros = bytes(1 << 20)
    if how == "lz4":
        packed = io.BytesIO()
        with lz4.frame.open(packed, "wb") as stream:
            for _ in range(size >> 20):
                stream.write(zeros)
        content = packed.getvalue()
    else:
        packer = zstandard.ZstdCompressor().compressobj()
        content = b"".join(packer.compress(zeros) for _ in range(size >> 20)) + packer.flush()
    changed, done = [], False
    for opcode, body in records(data):
        if opcode == Opcode.CHUNK and not done:
            done = True
            said = {"says little": 1000, "says all": size, "lz4": 1000}[how]
            name = b"lz4" if how == "lz4" else b"zstd"
            head = body[:16] + struct.pack("<QI", said, 0) + struct.pack("<I", len(name)) + name
            body = head + struct.pack("<Q", len(content)) + content
        changed.append((opcode, body))
    return file_of(changed)


@fault("bombs", "a chunk that unpacks to 2 GB, whatever it says of itself", 3, 1)
def bombs(this: Try) -> None:
    how = ("says little", "lz4", "says all")[this.index % 3]
    broken = this.folder / "bomb.mcap"
    broken.write_bytes(bomb(this, log(this).read_bytes(), how, 2 << 30))
    for command in (("steps", broken), ("recover", broken, "-o", this.folder / "fixed.mcap")):
        done = this.visitlab(*command, limit=90)
        this.told(done, 0, 4)
        this.wrong += [f"{how}: {done.words} held {done.memory >> 20} MB"] * (done.memory > MEMORY)


@fault("absent-trial", "a trial that a log of 300 MB does not hold: bounded memory", 1)
def absent_trial(this: Try) -> None:
    from tests.log.blocks import random_steps, record

    columns, rows = random_steps(trials=50_000, trial_steps=100)
    file = record(this.folder / "large.mcap", "visit", columns, rows, block=8192)
    done = this.visitlab("steps", file, "--trial", 99_999_999)
    this.told(done, 5, names="99999999")
    this.wrong += [f"held {done.memory >> 20} MB"] * (done.memory > 300 << 20)
    file.unlink()


@fault("impossible-values", "a log with a row, a room, an action that there is not: refused in a line", 8, 0)
def impossible_values(this: Try) -> None:
    original = log(this, "visit/fast").read_bytes()
    fields = ["robot_row", "robot_col", "human_row", "robot_heading", "action", "goal_room", "distance", "angle"]
    name = fields[this.index % len(fields)]
    file = this.folder / "other.mcap"
    file.write_bytes(
        rewritten_with(
            original, name, this.random.choice([99, 4_000_000_000 if name.endswith(("row", "col")) else 120])
        )
    )
    this.told(this.visitlab("steps", file, "--trial", 3), 4, names=name)
    this.told(this.visitlab("replay", file, "--trial", 3, "--strip", this.folder / "x.svg"), 4, names=name)


def rewritten_with(data: bytes, name: str, value: int) -> bytes:
    """A log in which a field of every thousandth message from the 310th on has another value."""
    target = io.BytesIO()
    writer = Writer(target)
    writer.start()
    reader = make_reader(io.BytesIO(data))
    for metadata in reader.iter_metadata():
        writer.add_metadata(metadata.name, metadata.metadata)
    pool, channels = DescriptorPool(), {}
    step = None
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        assert schema is not None
        if channel.id not in channels:
            ours = writer.register_schema(schema.name, schema.encoding, schema.data)
            channels[channel.id] = writer.register_channel(channel.topic, "protobuf", ours)
        if step is None:
            pool.Add(FileDescriptorSet.FromString(schema.data).file[0])
            step = GetMessageClass(pool.FindMessageTypeByName("visitlab.Step"))
        content = message.data
        if channel.topic == "/step" and message.log_time // 10**9 % 1000 == 310:
            changed = step.FromString(content)
            setattr(changed, name, value)
            content = changed.SerializeToString()
        writer.add_message(channels[channel.id], message.log_time, content, message.publish_time, message.sequence)
    writer.finish()
    return target.getvalue()
