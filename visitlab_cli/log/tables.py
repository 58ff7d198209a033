"""Columns as a table of pandas or Arrow, enums as numbers or, if `named`, as categories with their names."""

import importlib
from typing import Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.log.reader import Columns
from visitlab_cli.world.columns import COLUMNS

_ENUMS = {column.name: column.enum for column in COLUMNS if column.enum}


def names_of(column: str) -> tuple[str, ...]:
    """The names of a column's values, in the order of the values from 0; empty where it is no enum."""
    enum = _ENUMS.get(column)
    return tuple(value.name for value in enum) if enum else ()


def _codes(columns: Columns, name: str) -> npt.NDArray[np.int8]:
    """An enum's numbers, signed: what pandas, and pyarrow before 23, take for a category.

    Raises:
        RunError: one of them has no name.
    """
    values: npt.NDArray[Any] = columns[name]
    if len(values) and (most := values.max()) >= len(names_of(name)):
        raise RunError(f"{name} has the value {most}, which there is not")
    return values.astype(np.int8, copy=False) if values.dtype != np.uint8 else values.view(np.int8)


def to_arrow(columns: Columns, *, named: bool = False) -> Any:
    """A `pyarrow.Table` on the arrays' own memory (only bools are packed anew), made by whatever read the columns."""
    import pyarrow

    def array(name: str) -> Any:
        if named and (names := names_of(name)):
            return pyarrow.DictionaryArray.from_arrays(pyarrow.array(_codes(columns, name)), list(names))
        return pyarrow.array(columns[name])

    return pyarrow.table({name: array(name) for name in columns})


def to_pandas(columns: Columns, *, named: bool = False) -> Any:
    """A `pandas.DataFrame`.

    Raises:
        UsageError: pandas, which visitlab does not need itself, is not installed.
    """
    try:
        pandas = importlib.import_module("pandas")
    except ImportError as error:
        raise UsageError("to_pandas needs pandas: pip install pandas") from error

    def series(name: str) -> Any:
        if named and (names := names_of(name)):
            return pandas.Categorical.from_codes(_codes(columns, name), categories=list(names))
        return columns[name]

    return pandas.DataFrame({name: series(name) for name in columns})
