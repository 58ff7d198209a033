"""Trials, steps, models or results of a run as a CSV or Parquet file, cell by cell, so that memory does not grow."""

import contextlib
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.summary import Summary, summaries
from visitlab_cli.results.tables import Reader, model_of, steps_of, tables, trials_of
from visitlab_cli.whole_file import new_file

RESULTS = "results"
READERS: dict[str, Reader] = {"trials": trials_of, "steps": steps_of, "models": model_of}
CONTENTS = (*READERS, RESULTS)
CSV, PARQUET = "csv", "parquet"
TEXTS = ("name", "experiment", "agent", "human", "measure", "n_of", "sources")
COUNTS = ("cells_done", "cells", "n")
STARTS_FORMULA = re.compile("[\\s\ufeff\u200b]*[=+\\-@\uff1d\uff0b\uff0d\uff20]|[\\t\\r\\n]")
"""What spreadsheets take for a formula, some after a space, some in wide letters, some after a break."""
NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?(inf|nan)", re.ASCII)


def export_table(run: Path, cells: Sequence[Cell], content: str, file: Path) -> int:
    """Write one of `CONTENTS` of finished cells, at least one, to a new file, whose name ends in .csv or .parquet.

    Returns:
        The number of rows.

    Raises:
        UsageError: the file exists.
        NotFoundError: a cell has no steps.
        RunError: a cell is damaged, or the file cannot be written, as where there is no folder for it.
    """
    if not file.absolute().parent.is_dir():
        raise RunError(f"{file}: can't be written: there is no folder {file.parent}")
    parts = _results(run, cells) if content == RESULTS else _aligned(run, cells, READERS[content])
    with new_file(file) as beside:
        return _write(parts, beside, file.suffix == f".{CSV}")


def _results(run: Path, cells: Sequence[Cell]) -> Iterator[Any]:
    yield results_table(summaries(run, cells))


def results_table(lines: Sequence[Summary]) -> Any:
    """The lines of the summary, at least one, as a `pyarrow.Table`; a column's type is the same whatever is missing."""
    import pyarrow

    rows = [line.as_row() for line in lines]
    texts = {*TEXTS, *(path for line in lines for path, _ in line.group.point)}
    types = {
        name: pyarrow.string() if name in texts else pyarrow.int64() if name in COUNTS else pyarrow.float64()
        for row in rows
        for name in row
    }
    return pyarrow.Table.from_pylist(rows, pyarrow.schema(list(types.items())))


def _aligned(run: Path, cells: Sequence[Cell], read: Reader) -> Iterator[Any]:
    """The cells' tables, all with the same columns: one of each task, with what else it has, tells which these are."""
    import pyarrow

    one_of_each = {(cell.task, cell.parts): cell for cell in reversed(cells)}.values()
    schemas = [read(run, cell).schema for cell in one_of_each]
    for table in tables(run, cells, read):
        schema = pyarrow.unify_schemas([table.schema, *schemas])
        schemas = [schema]
        yield pyarrow.concat_tables([schema.empty_table(), table], promote_options="default")


def _write(parts: Iterator[Any], file: Path, as_csv: bool) -> int:
    from pyarrow import csv, parquet

    rows, writer = 0, None
    with file.open("wb") as sink, contextlib.ExitStack() as whole:  # pyarrow takes not every name of a file
        for table in parts:
            table = for_spreadsheets(table) if as_csv else table
            if writer is None:
                writer = whole.enter_context((csv.CSVWriter if as_csv else parquet.ParquetWriter)(sink, table.schema))
            writer.write_table(table)
            rows += table.num_rows
    return rows


def for_spreadsheets(table: Any) -> Any:
    """A table as CSV can hold it: texts as they are, but none, head or cell, that a spreadsheet takes for a formula."""
    import pyarrow

    for place, column in enumerate(table.schema):
        kind = column.type
        if pyarrow.types.is_dictionary(kind):
            table = table.set_column(place, column.name, table.column(place).cast(kind.value_type))
        if _is_text(table.schema.field(place).type):
            encoded = table.column(place).combine_chunks().dictionary_encode()
            texts = pyarrow.array([harmless(text) for text in encoded.dictionary.to_pylist()], pyarrow.string())
            table = table.set_column(place, column.name, texts.take(encoded.indices))
    return table.rename_columns([harmless(name) for name in table.column_names])


def _is_text(kind: Any) -> bool:
    import pyarrow

    return bool(pyarrow.types.is_string(kind) or pyarrow.types.is_large_string(kind))


def harmless(text: str) -> str:
    """A text with an apostrophe before it where a spreadsheet would take it for a formula; numbers stay."""
    return f"'{text}" if STARTS_FORMULA.match(text) and not NUMBER.fullmatch(text) else text
