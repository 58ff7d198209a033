"""What writer and reader of a log agree on: its names, and the protobuf schema derived from the columns.

A field's number is its column's place in the table, from 1. Every field is proto3 `optional`, so that a value
of zero is written too and a message has a constant size. A log carries the schema, hence any MCAP reader
decodes it.
"""

from collections.abc import Iterator
from enum import IntEnum

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from visitlab_cli.world.columns import ALWAYS, BOOL, COLUMNS, ENUM, FIXED32, FLOAT, MODULES, PHASES, UINT32, Column
from visitlab_cli.world.tasks import TASK_NAMES, tasks_with

FORMAT = "1"
METADATA_NAME = "visitlab"
CONFIG_NAME = "config.yaml"
ONE_TRIAL_IN = "one_trial_in"
STEP_NS = 1_000_000_000  # a step takes one simulated second

PACKAGE = "visitlab"
STEP, TRIAL = "Step", "Trial"
STEP_TOPIC, TRIAL_TOPIC = "/step", "/trial"

FIXED64 = "fixed64"
TRIAL_COLUMNS = (
    Column(FIXED32, ALWAYS, "number of the trial, from 0", name="trial"),
    Column(FIXED64, ALWAYS, "log time of its step 0, in ns", name="first_step_time"),
    Column(FLOAT, ALWAYS, "sum of the task's rewards", name="reward"),
    Column(FIXED32, ALWAYS, "number of its steps, step 0 not counted", name="steps"),
    Column(FIXED32, MODULES, "goals that the human reached", name="goals"),
)
TABLES = {STEP: COLUMNS, TRIAL: TRIAL_COLUMNS}

PROTOBUF_TYPES = {
    FIXED32: FieldDescriptorProto.TYPE_FIXED32,
    FIXED64: FieldDescriptorProto.TYPE_FIXED64,
    FLOAT: FieldDescriptorProto.TYPE_FLOAT,
    BOOL: FieldDescriptorProto.TYPE_BOOL,
    UINT32: FieldDescriptorProto.TYPE_UINT32,
    ENUM: FieldDescriptorProto.TYPE_ENUM,
}


def file_descriptor(*, phased: bool = False) -> FileDescriptorProto:
    """The schema of the log as one .proto file; `phased`: of a log that tells phases."""
    return FileDescriptorProto(
        name="visitlab.proto",
        package=PACKAGE,
        syntax="proto3",
        message_type=[message_descriptor(name, phased=phased) for name in TABLES],
        enum_type=[_enum_descriptor(enum) for enum in _enums()],
    )


def schema_bytes(*, phased: bool = False) -> bytes:
    """The schema as MCAP carries it: a serialised FileDescriptorSet."""
    return FileDescriptorSet(file=[file_descriptor(phased=phased)]).SerializeToString(deterministic=True)


def message_descriptor(message: str, *, phased: bool = False) -> DescriptorProto:
    """The descriptor of the message `STEP` or `TRIAL`; `phased` as `file_descriptor` says."""
    descriptor = DescriptorProto(name=message)
    for index, column in enumerate(TABLES[message]):
        if column.part == PHASES and not phased:
            continue  # a log without phases has the schema that it always had
        descriptor.field.add(
            name=column.name,
            number=index + 1,
            label=FieldDescriptorProto.LABEL_OPTIONAL,
            type=PROTOBUF_TYPES[column.kind],
            type_name=f".{PACKAGE}.{column.enum.__name__}" if column.enum else None,
            proto3_optional=True,
            oneof_index=index,
        )
        descriptor.oneof_decl.add(name=f"_{column.name}")  # what makes a proto3 field optional
    return descriptor


def proto_text() -> str:
    """The schema as a .proto file for people, each field with its meaning and its tasks."""
    blocks = ['syntax = "proto3";', f"package {PACKAGE};"]
    for message, columns in TABLES.items():
        lines = [
            f"  optional {column.enum.__name__ if column.enum else column.kind} {column.name} = {number};"
            f"  // {column.meaning} ({tasks_in_words(column)})"
            for number, column in enumerate(columns, 1)
        ]
        blocks.append("\n".join([f"message {message} {{", *lines, "}"]))
    for enum in _enums():
        values = [f"  {value.name} = {value};" for value in enum]
        blocks.append("\n".join([f"enum {enum.__name__} {{", *values, "}"]))
    return "\n\n".join(blocks) + "\n"


def tasks_in_words(column: Column) -> str:
    """Which tasks have a column: `all`, or their names; or that it is there with phases only."""
    if column.part == PHASES:
        return "with phases"
    tasks = tasks_with(column.part)
    return "all" if tasks == TASK_NAMES else ", ".join(tasks)


def _enums() -> Iterator[type[IntEnum]]:
    """The enums that the columns name, each once."""
    yield from dict.fromkeys(column.enum for column in COLUMNS if column.enum)


def _enum_descriptor(enum: type[IntEnum]) -> EnumDescriptorProto:
    descriptor = EnumDescriptorProto(name=enum.__name__)
    for value in enum:
        descriptor.value.add(name=value.name, number=value)
    return descriptor
