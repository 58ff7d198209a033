"""Blocks of steps with random and boundary values, and the protobuf library's view of them."""

from pathlib import Path
from typing import Any

import numpy as np
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message_factory import GetMessageClass

from visitlab_cli.log.schema import file_descriptor
from visitlab_cli.log.writer import StepRecorder
from visitlab_cli.world.columns import COLUMNS, FIXED32, FLOAT, SFIXED64, StepColumns, empty_columns
from visitlab_cli.world.tasks import columns_of

ATTRIBUTES = {"version": "0.1.0", "cell": "visit/human_2/seed-0000", "seed": "0"}
CONFIG = b"name: example\n"

BOUNDARIES = {
    SFIXED64: [-(2**63), -1, 0, 1, 2**63 - 1],
    FIXED32: [0, 1, 127, 128, 2**31, 2**32 - 1],
    FLOAT: [0.0, -0.0, 1.0, -1e30, 1e-45, np.inf],
}
BYTE_BOUNDARIES = [0, 1, 127]


def message_class(name: str, parts: tuple[str, ...] = ()) -> Any:
    """The protobuf library's class of `Step` or `Trial`, made from our descriptor."""
    pool = DescriptorPool()
    pool.Add(file_descriptor(parts))
    return GetMessageClass(pool.FindMessageTypeByName(f"visitlab.{name}"))


def random_steps(trials: int, trial_steps: int, seed: int = 0) -> tuple[StepColumns, int]:
    """Whole trials, a third of the other values at a boundary; rewards are 0, 1 or 2."""
    rng = np.random.default_rng(seed)
    rows = trials * (trial_steps + 1)
    columns = empty_columns(rows)
    for column, values in zip(COLUMNS, columns, strict=True):
        if values.dtype == np.bool_:
            values[:] = rng.random(rows) < 0.5
            continue
        boundaries = np.array(BOUNDARIES.get(column.kind, BYTE_BOUNDARIES), values.dtype)
        values[:] = rng.random(rows) * 127
        at_boundary = rng.random(rows) < 1 / 3
        values[at_boundary] = rng.choice(boundaries, at_boundary.sum())
    columns.trial[:] = np.repeat(np.arange(trials), trial_steps + 1)
    columns.step[:] = np.tile(np.arange(trial_steps + 1), trials)
    columns.reward[:] = rng.integers(0, 3, rows)
    return columns, rows


def record(path: Path, task: str, columns: StepColumns, rows: int, *, block: int | None = None, **options: Any) -> Path:
    """Write the first `rows` rows, `block` at a time."""
    size = block or max(rows, 1)
    with StepRecorder(path, task, attributes=ATTRIBUTES, config_yaml=CONFIG, **options) as recorder:
        for start in range(0, rows, size):
            part = StepColumns(*(values[start : start + size] for values in columns))
            recorder.write(part, min(size, rows - start))
    return path


def serialized(message: Any, task: str, columns: StepColumns, row: int) -> bytes:
    """One row as the protobuf library serialises it."""
    return message(
        **{column.name: getattr(columns, column.name)[row].item() for column in columns_of(task)}
    ).SerializeToString()
