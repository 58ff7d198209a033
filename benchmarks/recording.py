"""What recording costs: CPU and bytes a step, its floor, and how much faster it is than the mcap-protobuf writer.

    python -m benchmarks.recording [LOG ...]

Each LOG, a steps.mcap of a run, is recorded anew. Without one, for each task, steps whose fields are drawn
independently and uniformly from their ranges: a log of a simulation repeats itself and is smaller. The floor is what
compressing, checksums and digest of the same log take alone: beside playing, too, a step takes no less by the clock.
"""

import argparse
import hashlib
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import zstandard
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass
from mcap.records import Chunk
from mcap.stream_reader import StreamReader
from mcap_protobuf.writer import Writer

from benchmarks.rows import Row, number, show
from visitlab_cli.log.mcap_file import COMPRESSION_PARAMETERS
from visitlab_cli.log.reader import read_metadata, read_steps
from visitlab_cli.log.schema import STEP_NS, STEP_TOPIC, file_descriptor
from visitlab_cli.log.writer import StepRecorder
from visitlab_cli.world.columns import FLOAT, StepColumns, empty_columns
from visitlab_cli.world.tasks import SOCIAL, TASK_NAMES, VISIT, columns_of

BLOCK_ROWS = 8192
STEPS = 40 * BLOCK_ROWS
STEPS_OF_STOCK_WRITER = 20_000
REPEATS = 3
RANGES = {"state": 2560, "distance": 5, "goal_room": 9}
GRID = {SOCIAL: 120}


def drawn_steps(task: str) -> StepColumns:
    """Whole trials of the task's usual length with uniform values."""
    random = np.random.default_rng(0)
    trial_rows = 101 if task == VISIT else 21
    columns = empty_columns(STEPS)
    for column in columns_of(task):
        values = getattr(columns, column.name)
        is_flag = column.kind == FLOAT or values.dtype == np.bool_
        largest = 2 if is_flag else len(column.enum) if column.enum else GRID.get(task, 24)
        values[:] = random.integers(0, RANGES.get(column.name, largest), STEPS)
    columns.trial[:] = np.arange(STEPS) // trial_rows
    columns.step[:] = np.arange(STEPS) % trial_rows
    return columns


def logged_steps(path: Path) -> StepColumns:
    """The steps of a log."""
    found = read_steps(path)
    columns = empty_columns(len(found["trial"]))
    return columns._replace(**found)


def record(path: Path, task: str, columns: StepColumns) -> None:
    with StepRecorder(path, task, attributes={}, config_yaml=b"") as recorder:
        for start in range(0, len(columns.trial), BLOCK_ROWS):
            block = StepColumns(*(values[start : start + BLOCK_ROWS] for values in columns))
            recorder.write(block, len(block.trial))


def record_with_stock_writer(path: Path, task: str, columns: StepColumns) -> None:
    pool = DescriptorPool()
    pool.Add(file_descriptor())
    message = GetMessageClass(pool.FindMessageTypeByName("visitlab.Step"))
    names = [column.name for column in columns_of(task)]
    lists = [getattr(columns, name)[:STEPS_OF_STOCK_WRITER].tolist() for name in names]
    with path.open("wb") as file, Writer(file) as writer:
        for number, row in enumerate(zip(*lists, strict=True)):
            now = number * STEP_NS
            step = message(**dict(zip(names, row, strict=True)))
            writer.write_message(STEP_TOPIC, step, log_time=now, publish_time=now, sequence=number)


def compress_and_check(data: bytes, contents: Sequence[bytes]) -> None:
    """What a log of these `data` and `contents` of its chunks needs, whoever writes it."""
    compressor = zstandard.ZstdCompressor(compression_params=COMPRESSION_PARAMETERS)
    for content in contents:
        compressor.compress(content)
        zlib.crc32(content)
    zlib.crc32(data)
    hashlib.sha256(data).digest()


def contents_of(path: Path) -> list[bytes]:
    """What the chunks of a log hold, uncompressed."""
    with path.open("rb") as file:
        chunks = [record for record in StreamReader(file, emit_chunks=True).records if isinstance(record, Chunk)]
    return [zstandard.ZstdDecompressor().decompress(chunk.data, chunk.uncompressed_size) for chunk in chunks]


def cpu_seconds(work: Callable[..., None], *given: Any) -> float:
    """The least CPU time of a few repeats."""
    seconds = []
    for _ in range(REPEATS):
        start = time.process_time()
        work(*given)
        seconds.append(time.process_time() - start)
    return min(seconds)


def of_log(name: str, task: str, columns: StepColumns, folder: Path) -> Iterator[Row]:
    """What these steps cost and take."""
    ours, stock = folder / "ours.mcap", folder / "stock.mcap"
    steps = len(columns.trial)
    our_cost = cpu_seconds(record, ours, task, columns) / steps
    stock_steps = min(steps, STEPS_OF_STOCK_WRITER)
    stock_cost = cpu_seconds(record_with_stock_writer, stock, task, columns) / stock_steps
    beside = f"mcap-protobuf {number(1e6 * stock_cost)}"
    yield Row(f"recording {name}", 1e6 * our_cost, "us of CPU a step", beside, our_cost / stock_cost)
    floor = cpu_seconds(compress_and_check, ours.read_bytes(), contents_of(ours)) / steps
    beside = f"recording {number(1e6 * our_cost)}"
    yield Row(f"the floor of {name}", 1e6 * floor, "us of CPU a step", beside, floor / our_cost)
    sizes = ours.stat().st_size / steps, stock.stat().st_size / stock_steps
    yield Row(f"log of {name}", sizes[0], "bytes a step", f"mcap-protobuf {number(sizes[1])}", sizes[0] / sizes[1])


def rows(logs: Sequence[Path] = ()) -> Iterator[Row]:
    """Of logs, or of uniform steps of each task."""
    with tempfile.TemporaryDirectory() as folder:
        for log in logs:
            name = "/".join(log.parts[-4:-2])
            yield from of_log(name, read_metadata(log)["task"], logged_steps(log), Path(folder))
        for task in () if logs else TASK_NAMES:
            yield from of_log(f"{task}, uniform", task, drawn_steps(task), Path(folder))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("logs", nargs="*", type=Path, metavar="LOG", help="a steps.mcap of a run")
    show(rows(parser.parse_args().logs))


if __name__ == "__main__":
    main()
