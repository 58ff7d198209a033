"""A message of the log as a record of constant size: a block of them is one numpy structured array.

A record is what MCAP stores of a message: opcode, length, channel, sequence, log time, publish time, then for
each field its tag and its value as protobuf serialises them, in the order of the field numbers. All of it
follows from the descriptor of the message. A varint (bool, enum, uint32) takes one byte up to `VARINT_MAX`.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
import numpy.typing as npt
from google.protobuf.descriptor_pb2 import FieldDescriptorProto
from mcap.opcode import Opcode

from visitlab_cli.log.schema import STEP, TABLES, TRIAL, Parts, message_descriptor
from visitlab_cli.world.tasks import TASKS

Records = npt.NDArray[np.void]

STEP_CHANNEL, TRIAL_CHANNEL = 1, 2
CHANNELS = {STEP: STEP_CHANNEL, TRIAL: TRIAL_CHANNEL}
VARINT_MAX = 127

_ENVELOPE = (("opcode", "u1"), ("length", "<u8"))
_HEADER = (("channel", "<u2"), ("sequence", "<u4"), ("log_time", "<u8"), ("publish_time", "<u8"))

# Wire types (protobuf.dev/programming-guides/encoding) and the numpy type of the value's bytes.
_VARINT, _I64, _I32 = 0, 1, 5
_WIRE = {
    FieldDescriptorProto.TYPE_FIXED32: (_I32, "<u4"),
    FieldDescriptorProto.TYPE_FIXED64: (_I64, "<u8"),
    FieldDescriptorProto.TYPE_SFIXED64: (_I64, "<i8"),
    FieldDescriptorProto.TYPE_FLOAT: (_I32, "<f4"),
    FieldDescriptorProto.TYPE_BOOL: (_VARINT, "?"),
    FieldDescriptorProto.TYPE_UINT32: (_VARINT, "u1"),
    FieldDescriptorProto.TYPE_ENUM: (_VARINT, "u1"),
}


@dataclass(frozen=True)
class Layout:
    """The bytes of a message: `dtype` of a record, its `constants`, the names of `fields` and `varints`."""

    dtype: np.dtype[np.void]
    constants: dict[str, int]
    fields: tuple[str, ...]
    varints: tuple[str, ...]

    def blank(self, rows: int) -> Records:
        """A block of `rows` records with the constants filled in."""
        records = np.zeros(rows, self.dtype)
        for name, value in self.constants.items():
            records[name] = value
        return records

    def matches(self, records: Records) -> npt.NDArray[np.bool_]:
        """Which of the `records` have the constants of this layout, and each varint in one byte."""
        same = np.ones(len(records), np.bool_)
        for name, value in self.constants.items():
            same &= records[name] == value
        for name in self.varints:
            most = 1 if self.dtype[name] == np.bool_ else VARINT_MAX
            same &= records[name].view(np.uint8) <= most
        return same


@cache
def layout_of(message: str, task: str, parts: Parts = ()) -> Layout:
    """The layout of the message `STEP` or `TRIAL` in the log of a `task`, and what else its cell has."""
    names = {column.name for column in TABLES[message] if column.part in (*TASKS[task].parts, *parts)}
    fields = [field for field in message_descriptor(message, parts).field if field.name in names]
    columns = [*_ENVELOPE, *_HEADER]
    constants = {"opcode": int(Opcode.MESSAGE), "channel": CHANNELS[message]}
    for field in sorted(fields, key=lambda field: field.number):
        wire_type, value_type = _WIRE[field.type]
        tag = _varint(field.number << 3 | wire_type)
        columns += [(_tag_of(field.name), f"<u{len(tag)}"), (field.name, value_type)]
        constants[_tag_of(field.name)] = int.from_bytes(tag, "little")
    dtype = np.dtype(columns)
    constants["length"] = dtype.itemsize - np.dtype(list(_ENVELOPE)).itemsize
    varints = tuple(field.name for field in fields if _WIRE[field.type][0] == _VARINT)
    return Layout(dtype, constants, tuple(field.name for field in fields), varints)


def _tag_of(name: str) -> str:
    return f"tag of {name}"


def _varint(value: int) -> bytes:
    """A number as a protobuf varint: seven bits a byte, the lowest first, the top bit set but in the last."""
    encoded = []
    while value > VARINT_MAX:
        encoded.append(value & VARINT_MAX | VARINT_MAX + 1)
        value >>= 7
    return bytes([*encoded, value])
