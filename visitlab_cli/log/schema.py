"""What writer and reader of a log agree on: its names, and the protobuf schema derived from the columns.

A field's number is its column's place in the table, from 1; what only some cells have is in the schema of their
logs only. Every field is proto3 `optional`, so that a value of zero is written too and a message has a constant size.
A log carries the schema, hence any MCAP reader decodes it.
"""

from collections.abc import Collection, Iterator
from enum import IntEnum

from google.protobuf.descriptor_pb2 import (
    DescriptorProto,
    EnumDescriptorProto,
    FieldDescriptorProto,
    FileDescriptorProto,
    FileDescriptorSet,
)

from visitlab_cli.world.columns import (
    ALWAYS,
    BELIEF,
    BOOL,
    COLUMNS,
    DOORS,
    ENUM,
    FIXED32,
    FLOAT,
    MEMORY,
    MODELS,
    MODULES,
    PHASES,
    PLAN,
    SFIXED64,
    SOME_CELLS,
    UINT32,
    Column,
)
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
    SFIXED64: FieldDescriptorProto.TYPE_SFIXED64,
    FLOAT: FieldDescriptorProto.TYPE_FLOAT,
    BOOL: FieldDescriptorProto.TYPE_BOOL,
    UINT32: FieldDescriptorProto.TYPE_UINT32,
    ENUM: FieldDescriptorProto.TYPE_ENUM,
}


Parts = tuple[str, ...]
"""Those of `SOME_CELLS` that a log has."""


def parts_in(names: Collection[str]) -> Parts:
    """Those that a log has whose steps have columns of these names."""
    return tuple(part for part in SOME_CELLS if all(each.name in names for each in COLUMNS if each.part == part))


def file_descriptor(parts: Parts = ()) -> FileDescriptorProto:
    """The schema of a log as one .proto file."""
    return FileDescriptorProto(
        name="visitlab.proto",
        package=PACKAGE,
        syntax="proto3",
        message_type=[message_descriptor(name, parts) for name in TABLES],
        enum_type=[_enum_descriptor(enum) for enum in _enums()],
    )


def schema_bytes(parts: Parts = ()) -> bytes:
    """The schema as MCAP carries it: a serialised FileDescriptorSet."""
    return FileDescriptorSet(file=[file_descriptor(parts)]).SerializeToString(deterministic=True)


def message_descriptor(message: str, parts: Parts = ()) -> DescriptorProto:
    """The descriptor of the message `STEP` or `TRIAL`."""
    descriptor = DescriptorProto(name=message)
    there = [
        (number, column)
        for number, column in enumerate(TABLES[message], 1)
        if column.part not in SOME_CELLS or column.part in parts
    ]
    for index, (number, column) in enumerate(there):
        descriptor.field.add(
            name=column.name,
            number=number,
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


_WITH = {
    PHASES: "with phases",
    DOORS: "with doors of a phase",
    BELIEF: "with a belief",
    PLAN: "with a plan",
    MODELS: "with an agent of several models",
    MEMORY: "with a human who remembers",
}


def tasks_in_words(column: Column) -> str:
    """Which tasks have a column: `all`, or their names; or which cells."""
    if column.part in SOME_CELLS:
        return _WITH[column.part]
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
