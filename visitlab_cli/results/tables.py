"""Trials, steps and models of many cells as one Arrow table, each row with the cell that it comes from."""

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.errors import NotFoundError
from visitlab_cli.log.reader import check_values, read_steps
from visitlab_cli.log.tables import to_arrow
from visitlab_cli.plan import saved
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.groups import point_of
from visitlab_cli.storage.cell_folder import STEPS

Reader = Callable[[Path, Cell], Any]
"""From a run's folder and a cell to its `pyarrow.Table`."""
_MODEL_SEED = re.compile(r"/model-(\d+)/")


def trials_of(run: Path, cell: Cell) -> Any:
    """A row a trial: `trial`, `reward`, in a visit `goals`."""
    return to_arrow(saved.trials_of(run, cell))


def steps_of(run: Path, cell: Cell, columns: Sequence[str] | None = None) -> Any:
    """A row a recorded step: the log's columns, or those asked for, enums by their names.

    Raises:
        NotFoundError: the cell has no log.
        RunError: it is damaged, or has values that there are not.
    """
    folder = run / cell.path
    if not (folder / STEPS).is_file():
        raise NotFoundError(f"{folder}: has no log, its config records no steps; run it with record.steps=every")
    steps = read_steps(folder / STEPS, columns)
    check_values(folder / STEPS, steps, cell.task, lab_of(cell.settings))
    return to_arrow(steps, named=True)


def model_of(run: Path, cell: Cell) -> Any:
    """A row a state and action: `state`, `action`, and each table of the model that has a value for them."""
    arrays = saved.model_of(run, cell)
    setting = saved.setting_of(cell)
    states, actions = setting.n_states, setting.n_actions
    tables = {name: array.ravel() for name, array in arrays.items() if array.shape == (states, actions)}
    index = np.indices((states, actions), dtype=np.int32).reshape(2, -1)
    return to_arrow({"state": index[0], "action": index[1], **tables})


def tables(run: Path, cells: Sequence[Cell], read: Reader) -> Iterator[Any]:
    """The table of each cell, in front of its own columns those that say which cell: the same for all cells.

    They are `experiment`, `agent`, `human`, a column for each path that varies (numbers where all its values are),
    `model_seed` where models are crossed, `seed`; what a cell has none of is null.
    """
    labels = [_labels(cell) for cell in cells]
    kinds = {name: _kind([each.get(name) for each in labels]) for each in labels for name in each}
    names = [name for name in kinds if name not in LAST] + [name for name in LAST if name in kinds]
    for cell, values in zip(cells, labels, strict=True):
        table = read(run, cell)
        for place, name in enumerate(names):
            table = table.add_column(place, name, _repeated(values.get(name), kinds[name], table.num_rows))
        yield table


def stacked(run: Path, cells: Sequence[Cell], read: Reader) -> Any:
    """The tables of the cells as one, at least one; a column that a cell lacks is null there."""
    import pyarrow

    return pyarrow.concat_tables(tables(run, cells, read), promote_options="default").unify_dictionaries()


LAST = ("model_seed", "seed")


def _labels(cell: Cell) -> dict[str, str]:
    """What says which cell it is, as text; empty where it has none."""
    model = _MODEL_SEED.search(cell.path)
    named = {"experiment": cell.experiment, "agent": cell.agent, "human": cell.human, **dict(point_of(cell))}
    return named | ({"model_seed": model[1]} if model else {}) | {"seed": str(cell.seed)}


def _kind(texts: Sequence[str | None]) -> type:
    """What all texts can be read as: int, float, else str."""
    for kind in (int, float):
        try:
            _ = [kind(text) for text in texts if text]
        except ValueError:
            continue
        return kind if any(texts) else str
    return str


def _repeated(text: str | None, kind: type, rows: int) -> Any:
    """A column with one value, or null, in all rows; texts as a dictionary, which takes four bytes a row."""
    import pyarrow

    if kind is str:
        indices = pyarrow.repeat(pyarrow.scalar(0 if text else None, pyarrow.int32()), rows)
        return pyarrow.DictionaryArray.from_arrays(indices, pyarrow.array([text] if text else [], pyarrow.string()))
    of_kind = pyarrow.int64() if kind is int else pyarrow.float64()
    return pyarrow.repeat(pyarrow.scalar(kind(text) if text else None, of_kind), rows)
