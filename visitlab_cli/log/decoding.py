"""Messages of other writers as records of our layout, each value checked: any types and order of fields will do.

A field that a message lacks has protobuf's default, 0. A number may be of any numeric type, as long as the field can
have its value: 3.0 is a row, 3.7 and `true` are none.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from google.protobuf.descriptor_pb2 import DescriptorProto, FieldDescriptorProto

from visitlab_cli.log.layout import Layout, Records
from visitlab_cli.log.schema import TRIAL
from visitlab_cli.wording import shown
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT, columns_of

_Proto = FieldDescriptorProto
_FLOATS = {_Proto.TYPE_DOUBLE, _Proto.TYPE_FLOAT}
_UNSIGNED = {_Proto.TYPE_UINT64, _Proto.TYPE_FIXED64, _Proto.TYPE_UINT32, _Proto.TYPE_FIXED32}
_NO_NUMBERS = {_Proto.TYPE_STRING, _Proto.TYPE_BYTES, _Proto.TYPE_MESSAGE, _Proto.TYPE_GROUP}

Values = npt.NDArray[Any]


class RefusedError(Exception):
    """The file is whole, but holds what no log of visitlab holds; the message says what."""


class MessageKind:
    """What the messages of a channel are: those of a `topic`, decoded by the protobuf class `decoder`."""

    def __init__(self, topic: str, decoder: Any, message: str):
        declared = DescriptorProto()
        decoder.DESCRIPTOR.CopyToProto(declared)
        self.topic, self.decoder, self.message = topic, decoder, message
        self.sources = {field.name: _source_type(field) for field in declared.field}


class Decoded(NamedTuple):
    """A message, what it is, and the time of its record, in ns."""

    kind: MessageKind
    log_time: int
    message: Any


def as_records(decoded: Sequence[Decoded], layout: Layout) -> Records:
    """Messages of one topic as records of our `layout`.

    Raises:
        RefusedError: a value is none that its field can have; it names the first such message.
    """
    records = layout.blank(len(decoded))
    records["log_time"] = [each.log_time for each in decoded]
    for kind in {each.kind for each in decoded}:
        rows = [row for row, each in enumerate(decoded) if each.kind is kind]
        for name in layout.fields:
            if name in kind.sources:
                values = [getattr(decoded[row].message, name) for row in rows]
                fitting, is_right = fitted(values, kind.sources[name], layout.dtype[name])
                if not is_right.all():
                    wrong = int(np.argmin(is_right))
                    message = decoded[rows[wrong]].message
                    trial, step = (shown(_plain(getattr(message, key, 0))) for key in ("trial", "step"))
                    raise impossible(kind.message, trial, step, name, shown(_plain(values[wrong])))
                records[name][rows] = fitting
    return records


def impossible(message: str, trial: object, step: object, name: str, value: object) -> RefusedError:
    """The error of the message of a `trial`, or of its `step`, with a `value` that its field `name` cannot have."""
    where = f"the /trial message of trial {trial}" if message == TRIAL else f"step {step} of trial {trial}"
    return RefusedError(f"{where} has {name} {value}, which there is not")


def _plain(value: Any) -> Any:
    """A field's value as YAML knows it."""
    return value if isinstance(value, int | float | str | bytes) else [] if hasattr(value, "append") else {}


def _source_type(field: FieldDescriptorProto) -> np.dtype[Any]:
    """The type that all values of a field fit in; object where it holds no number, or many."""
    if field.label == _Proto.LABEL_REPEATED or field.type in _NO_NUMBERS:
        return np.dtype(object)
    if field.type == _Proto.TYPE_BOOL:
        return np.dtype(np.bool_)
    if field.type in _FLOATS:
        return np.dtype(np.float64)
    return np.dtype(np.uint64 if field.type in _UNSIGNED else np.int64)


def fitted(values: list[Any] | Values, source: np.dtype[Any], target: np.dtype[Any]) -> tuple[Values, Values]:
    """Values of a numeric `source` type as their `target` type, and which of them that type can have."""
    if source == np.object_ or (source == np.bool_ and target != np.bool_):
        return np.zeros(len(values), target), np.zeros(len(values), np.bool_)
    given: Values = np.array(values, source)
    with np.errstate(over="ignore", invalid="ignore"):
        if target.kind == "f":
            fitting = given.astype(target)
            return fitting, np.isfinite(fitting) | ~np.isfinite(given.astype(np.float64))
        most = 1 if target == np.bool_ else int(np.iinfo(target).max)
        least = int(np.iinfo(target).min) if target.kind == "i" and source.kind != "u" else 0
        is_right = (given >= least) & (given < float(most + 1) if source.kind == "f" else given <= most)
        if source.kind == "f":
            is_right &= given == np.floor(given)
        return np.where(is_right, given, 0).astype(target), is_right


class TaskGuess:
    """The task whose columns the steps of a log without metadata have, as its messages are seen."""

    def __init__(self) -> None:
        self._names: set[str] = set()

    def see(self, message: Any) -> None:
        """Take note of the fields that a message sets."""
        self._names.update(field.name for field, _ in message.ListFields())

    @property
    def is_sure(self) -> bool:
        """Whether no other message can change it."""
        return self.task == VISIT

    @property
    def task(self) -> str:
        """The task, so far."""
        for task, less in ((VISIT, SOCIAL), (SOCIAL, GO_TO_HUMAN), (GO_TO_HUMAN, NAVIGATION)):
            if self._names & (_of(task) - _of(less) - _of(NAVIGATION)):
                return task
        return NAVIGATION


def _of(task: str) -> set[str]:
    return {column.name for column in columns_of(task)}
