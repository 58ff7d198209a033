"""All that an agent and its task can remember, whatever their kinds: the arrays in their records, for a checkpoint.

Kernels change nothing but arrays in place. So the same arrays in records that were built anew are the same agent in
the same task, its scratch space included; of a record that makes room ahead, `filled` says how much is in use.
"""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.plain import Plain
from visitlab_cli.agents.symmetry import Fold
from visitlab_cli.world.geometry import Geometry
from visitlab_cli.world.lab import Lab

Array = npt.NDArray[Any]

CONSTANT = (Lab, Geometry, Fold)
"""Records that nothing changes, and that cells share."""


class ElsewhereError(Exception):
    """Something remembers in another place than an array, such as an agent in plain Python."""


class Part(NamedTuple):
    """An array, and how much of its first dimension is in use; None: all of it."""

    array: Array
    used: int | None


class Memory:
    """The arrays of several records, each once, in an order that the types of the records decide."""

    def __init__(self, records: Iterable[Any]) -> None:
        """Of these.

        Raises:
            ElsewhereError: they are not all.
        """
        self._records = tuple(records)
        self._parts()

    def saved(self) -> list[Array]:
        """What is in use of each array: views, which the next step changes."""
        return [array[:used] for array, used in self._parts()]

    def fits(self, saved: Sequence[Array]) -> bool:
        """Whether `saved` arrays are of these records."""
        parts = self._parts()
        return len(saved) == len(parts) and all(
            given.dtype == array.dtype
            and given.shape[1:] == array.shape[1:]
            and (len(given) == len(array) if used is None else len(given) <= len(array))
            for given, (array, used) in zip(saved, parts, strict=True)
        )

    def restore(self, saved: Sequence[Array]) -> None:
        """Make the arrays what was `saved`, which fits, in place."""
        for given, (array, _) in zip(saved, self._parts(), strict=True):
            array[: len(given)] = given

    def _parts(self) -> list[Part]:
        found: dict[tuple[Any, ...], Part] = {}
        for record in self._records:
            _collect(record, None, found)
        return list(found.values())


def _collect(value: Any, used: int | None, found: dict[tuple[Any, ...], Part]) -> None:
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject or value.ndim == 0:
            raise ElsewhereError(f"an array of {value.dtype} with {value.ndim} dimensions")
        if value.size and value.flags.writeable:
            place = value.__array_interface__["data"][0], value.shape, value.strides, value.dtype.str
            found.setdefault(place, Part(value, used))
    elif isinstance(value, CONSTANT):
        return
    elif isinstance(value, tuple) and not isinstance(value, Plain):
        lengths = value.filled() if hasattr(value, "filled") else {}
        for name, part in zip(getattr(value, "_fields", range(len(value))), value, strict=True):
            _collect(part, lengths.get(name), found)
    elif not isinstance(value, int | float | str | np.generic | None):
        raise ElsewhereError(f"a {type(value).__name__}")
