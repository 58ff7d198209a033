"""The bytes of a record, compared with what the protobuf library and the mcap library write."""

import struct

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from visitlab_cli.log.layout import layout_of
from visitlab_cli.log.schema import FIXED64, STEP, TABLES, TRIAL
from visitlab_cli.world.columns import BOOL, ENUM, FIXED32, FLOAT, SFIXED64, SOME_CELLS, UINT32
from visitlab_cli.world.tasks import TASK_NAMES, tasks_with

from .blocks import message_class

VALUES = {
    FIXED32: st.integers(0, 2**32 - 1),
    FIXED64: st.integers(0, 2**64 - 1),
    SFIXED64: st.integers(-(2**63), 2**63 - 1),
    FLOAT: st.floats(width=32, allow_nan=False),
    BOOL: st.booleans(),
    UINT32: st.integers(0, 127),
    ENUM: st.integers(0, 127),
}
ENVELOPE = struct.Struct("<BQHIQQ")  # opcode, length, channel, sequence, log time, publish time


@pytest.mark.parametrize("task", TASK_NAMES)
@pytest.mark.parametrize("message", [STEP, TRIAL])
@pytest.mark.parametrize("parts", [(), SOME_CELLS])
def test_a_record_holds_what_the_protobuf_library_serialises(message, task, parts):
    library, layout = message_class(message, parts), layout_of(message, task, parts)
    columns = [column for column in TABLES[message] if task in tasks_with(column.part) or column.part in parts]

    @settings(max_examples=150, deadline=None)
    @given(st.fixed_dictionaries({column.name: VALUES[column.kind] for column in columns}))
    def holds(values):
        record = layout.blank(1)
        for name, value in values.items():
            record[name] = value
        payload = library(**values).SerializeToString()
        head = ENVELOPE.pack(5, ENVELOPE.size - 9 + len(payload), layout.constants["channel"], 0, 0, 0)
        assert record.tobytes() == head + payload

    holds()


@pytest.mark.parametrize("name", ["opcode", "length", "channel", "tag of state", "tag of goal_room"])
def test_a_record_with_another_constant_does_not_match(name):
    layout = layout_of(STEP, "visit")
    records = layout.blank(3)
    records[name][1] += 1
    assert layout.matches(records).tolist() == [True, False, True]
