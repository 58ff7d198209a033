"""Random damage to logs of many makes: the reader and `recover` say one line, or what is true."""

import multiprocessing
import random
import resource
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np

from tests.log import raw
from tests.log.blocks import message_class, random_steps, record, serialized
from visitlab_cli.errors import VisitlabError
from visitlab_cli.log import writer
from visitlab_cli.log.reader import read_attachment, read_metadata, read_steps, read_trial, trials
from visitlab_cli.log.recovery.recovery import recover

TRIALS, TRIAL_STEPS = 3, 12
MEMORY = 2 << 30
NUMBERS = [0, 1, 8, 127, 128, 255, 2**16, 2**31, 2**32 - 1, 2**40, 2**63, 2**64 - 1]


def fuzz(n: int, seed: int, memory: int = MEMORY) -> list[str]:
    """Reads `n` damaged logs in a process of `memory` bytes of address space; a line for each wrong answer."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_child, args=(n, seed, memory, sender))
    child.start()
    sender.close()
    try:
        wrong: list[str] = receiver.recv()
    except EOFError:
        wrong = []
    child.join()
    return wrong if child.exitcode == 0 else [*wrong, f"seed {seed}: the process ended with {child.exitcode}"]


def _child(n: int, seed: int, memory: int, sender: "multiprocessing.connection.Connection") -> None:
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    sender.send(fuzz_here(n, seed))


def fuzz_here(n: int, seed: int) -> list[str]:
    """As `fuzz`, in this process."""
    wrong: list[str] = []
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("error")
        originals = _originals(Path(folder))
        for number in range(n):
            chosen = random.Random(f"{seed}/{number}")
            content = _damaged(chosen, originals)
            try:
                _check(Path(folder), content)
            except Exception as error:
                wrong.append(f"seed {seed}, input {number}: {type(error).__name__}: {str(error)[:200]}")
    return wrong


def _originals(folder: Path) -> list[bytes]:
    """Small logs: ours of each task, and other makes of the same steps."""
    steps, rows = random_steps(TRIALS, TRIAL_STEPS)
    writer.CHUNK_STEPS, before = 16, writer.CHUNK_STEPS
    try:
        ours = [record(folder / "ours.mcap", task, steps, rows).read_bytes() for task in ("navigation", "visit")]
    finally:
        writer.CHUNK_STEPS = before
    step = message_class("Step")
    messages = [raw.message(1, serialized(step, "visit", steps, row), row) for row in range(rows)]
    defined = raw.schema(1) + raw.channel(1)
    private = raw.record(raw.PRIVATE, b"private")
    return [
        *ours,
        raw.whole(raw.HEADER, defined, private.join(messages), raw.attachment()),
        raw.whole(raw.HEADER, raw.chunk(defined + b"".join(messages), "lz4")),
        raw.whole(
            raw.HEADER, raw.chunk(defined + b"".join(messages), "", crc=0), raw.metadata("visitlab", task="visit")
        ),
        raw.whole(raw.padded(raw.HEADER), defined, *(raw.padded(raw.chunk(each)) for each in messages[:20])),
    ]


def _flip(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    for _ in range(chosen.choice([1, 1, 2, 8])):
        data[chosen.randrange(len(data))] ^= 1 << chosen.randrange(8)


def _cut(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    del data[chosen.randrange(len(data)) :]


def _number(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    place, size = chosen.randrange(len(data)), chosen.choice([1, 2, 4, 8])
    data[place : place + size] = (chosen.choice(NUMBERS) % (1 << 8 * size)).to_bytes(size, "little")


def _blank(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    place = chosen.randrange(len(data))
    length = min(chosen.choice([1, 9, 100, 5000]), len(data) - place)
    data[place : place + length] = bytes(length) if chosen.random() < 0.5 else chosen.randbytes(length)


def _move(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    start = chosen.randrange(len(data))
    part = bytes(data[start : start + chosen.choice([9, 31, 200, 3000])])
    place = chosen.randrange(len(data))
    data[place:place] = part


def _join(chosen: random.Random, data: bytearray, others: list[bytes]) -> None:
    data += chosen.choice(others)


DAMAGES: list[Callable[[random.Random, bytearray, list[bytes]], None]] = [_flip, _cut, _number, _blank, _move, _join]


def _damaged(chosen: random.Random, originals: list[bytes]) -> bytes:
    data = bytearray(chosen.choice(originals))
    for _ in range(chosen.choice([1, 1, 1, 2, 3])):
        if data:
            chosen.choice(DAMAGES)(chosen, data, originals)
    return bytes(data)


def _check(folder: Path, content: bytes) -> None:
    """Read a log in every way; whatever is read has to be there after recovery, too."""
    path = folder / "broken.mcap"
    path.write_bytes(content)
    for other in folder.glob("broken.recovered*"):
        other.unlink()
    known = _told(lambda: read_steps(path))
    for number in (0, 1, 99):
        _told(lambda number=number: read_trial(path, number))
    for read in (read_metadata, trials, lambda path: read_attachment(path, "config.yaml")):
        _told(lambda read=read: read(path))
    saved = _told(lambda: recover(path))
    if path.read_bytes() != content:
        raise AssertionError("recover changed the file")
    if saved is not None:
        after = read_steps(saved.path)
        if known is not None and any(not np.array_equal(known[name], after[name], equal_nan=True) for name in known):
            raise AssertionError("recover lost what can be read")
        if saved.was_whole and saved.path.read_bytes() != content:
            raise AssertionError("a whole file is not copied as it is")
    elif known is not None and len(known["step"]):
        raise AssertionError("recover saves nothing of what can be read")


def _told(read: Callable[[], object]) -> object:
    """What is read, None where one line says why not."""
    try:
        return read()
    except VisitlabError as error:
        if "\n" in str(error):
            raise AssertionError(f"not one line: {error}") from error
        return None


if __name__ == "__main__":
    print("\n".join(fuzz(2000, 0)) or "nothing wrong")
