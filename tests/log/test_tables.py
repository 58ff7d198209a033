import sys

import numpy as np
import pytest

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.log.tables import names_of, to_arrow, to_pandas
from visitlab_cli.world.columns import COLUMNS
from visitlab_cli.world.enums import Action, InteractionLevel

from .blocks import random_steps, record


@pytest.fixture
def columns(tmp_path):
    steps, rows = random_steps(10, 20)
    for column, values in zip(COLUMNS, steps, strict=True):
        if column.enum:
            values %= len(column.enum)
    return read_steps(record(tmp_path / "a.mcap", "visit", steps, rows))


def test_enums_have_names_by_their_values():
    assert names_of("executed_action")[Action.HELLO] == "HELLO"
    assert names_of("interaction_level")[InteractionLevel.FOLLOWS] == "FOLLOWS"
    assert names_of("reward") == ()
    for column in COLUMNS:
        if column.enum:
            assert [column.enum[name] for name in names_of(column.name)] == list(range(len(column.enum)))


def test_arrow_holds_the_arrays_themselves(columns):
    table = to_arrow(columns)
    assert table.column_names == list(columns)
    for name, values in columns.items():
        np.testing.assert_array_equal(table[name].to_numpy(), values)
        if values.dtype != np.bool_:
            assert table[name].chunk(0).buffers()[1].address == values.ctypes.data


def test_arrow_with_names(columns):
    table = to_arrow(columns, named=True)
    assert table["action"].to_pylist() == [Action(value).name for value in columns["action"]]
    assert table["reward"].to_pylist() == columns["reward"].tolist()


def test_pandas_with_and_without_names(columns):
    pytest.importorskip("pandas")
    plain, named = to_pandas(columns), to_pandas(columns, named=True)
    for name, values in columns.items():
        np.testing.assert_array_equal(plain[name].to_numpy(), values)
    assert named["human_action"].tolist() == [Action(value).name for value in columns["human_action"]]
    assert named["action"].cat.codes.tolist() == columns["action"].tolist()
    assert named["state"].tolist() == columns["state"].tolist()


def test_without_pandas_it_says_so(columns, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(UsageError, match=r"^to_pandas needs pandas: pip install pandas$"):
        to_pandas(columns)


def test_categories_have_signed_numbers_as_pandas_wants_them(columns):
    for table in (
        to_arrow(columns, named=True),
        to_arrow({name: values[:0] for name, values in columns.items()}, named=True),
    ):
        kinds = {name: table.schema.field(name).type for name in columns if names_of(name)}
        assert {str(kind.index_type) for kind in kinds.values()} == {"int8"}
        assert not any(str(column.type) == "null" for column in table.schema)


def test_a_number_without_a_name_is_one_line(columns):
    wrong = columns | {"action": np.array([0, 31, 200], np.uint8)}
    for convert in (to_arrow, to_pandas):
        with pytest.raises(RunError, match=r"^action has the value 200, which there is not$"):
            convert({"action": wrong["action"]}, named=True)
