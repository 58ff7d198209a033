"""What a kind of agent says of each array that it saves, and whether arrays are so: what kernels may rely on."""

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.wording import shown

LARGEST = 1e30
"""No value or sum of rewards is larger; of such many can be added up."""
ROUNDING = 1e-6
"""What weights that were scaled and added up may be off."""
NAME = re.compile(r"[A-Za-z_]\w{0,60}")
"""What an array may be called."""
RESERVED = ("random_state", "belief_parameters", "belief_sums", "belief_speeds", "file", "allow_pickle")
"""What no array of an agent may be called: the first ones are a cell's own, the last two numpy's words."""
DTYPES = ("<f8", "<i4", "<i8", "<u8", "|b1", "<f4", "|i1", "|u1", "<i2", "<u2", "<u4")
MOST_ARRAYS = 64
MOST_BYTES = 256 << 20
"""Of all arrays of a model together."""
NO_NUMBER = "holds what is no number"
_OF_THE_CELL = 8
"""How many arrays a cell may add to its agent's, at most."""


class Declared(NamedTuple):
    """An array as it is saved: its dtype as numpy spells it, shape (None where it is free), least and largest value."""

    dtype: str
    shape: tuple[int | None, ...]
    low: float
    high: float


def floats(*shape: int | None) -> Declared:
    """Finite numbers."""
    return Declared("<f8", shape, -LARGEST, LARGEST)


def counts(*shape: int | None, low: int = 0, high: int = 2**31 - 1, dtype: str = "<i4") -> Declared:
    """Whole numbers from `low` to `high`."""
    return Declared(dtype, shape, low, high)


def weights(*shape: int | None) -> Declared:
    """Counts that may be parts of one, as where some of them were taken back."""
    return Declared("<f8", shape, 0.0, LARGEST)


RANDOM_STATE = Declared("<u8", (4,), 0, 2**64 - 1)


def fault_in_saved(arrays: Mapping[Any, npt.NDArray[Any]], reserved: tuple[str, ...] = RESERVED) -> str | None:
    """Why an agent's arrays can't be saved so that they are read again; None where they can."""
    for name, array in arrays.items():
        if not isinstance(name, str) or not NAME.fullmatch(name):
            return f"an array can't be called {shown(name)}: letters, digits and _, at most 61, a letter or _ first"
        if name in reserved:
            return f"an array can't be called {name}, a name of visitlab's own"
        if array.dtype.str not in DTYPES:
            return f"its array {name} is of dtype {array.dtype}, which is not kept"
        if not _is_finite(array):
            return f"its array {name} {NO_NUMBER}"
    if len(arrays) + _OF_THE_CELL > MOST_ARRAYS:
        return f"it has {len(arrays)} arrays; at most {MOST_ARRAYS - _OF_THE_CELL} are kept"
    if (total := sum(array.nbytes for array in arrays.values())) >= MOST_BYTES:
        return f"its arrays have {total:,} bytes; fewer than {MOST_BYTES:,} are kept"
    return None


def _is_finite(array: npt.NDArray[Any]) -> bool:
    return array.dtype.kind != "f" or bool(np.isfinite(array).all())


def fault_in_form(declared: Declared, dtype: str, shape: tuple[int, ...]) -> str | None:
    """Why an array with this dtype and shape is not as declared; None where it is."""
    fits = len(shape) == len(declared.shape) and all(
        there in (None, here) for there, here in zip(declared.shape, shape, strict=True)
    )
    if dtype == declared.dtype and fits:
        return None
    wanted = " x ".join("any" if size is None else str(size) for size in declared.shape)
    has = " x ".join(map(str, shape)) or "no"
    return f"is of kind {dtype} and {has} values, not {declared.dtype} and {wanted}"


def fault_in_values(declared: Declared, array: npt.NDArray[Any]) -> str | None:
    """Why an array's values are not as declared; None where they are."""
    if not _is_finite(array):
        return NO_NUMBER
    if array.dtype.kind in "if" and array.size and (array.min() < declared.low or array.max() > declared.high):
        return f"has values from {array.min()} to {array.max()}, not from {declared.low} to {declared.high}"
    return None


def fault_in_model(arrays: Mapping[str, npt.NDArray[Any]]) -> str | None:
    """What is wrong with a saved sparse model, as `saved_model` lays it out, each array being as it was declared."""
    offsets, states, seen = (arrays[f"successor_{name}"] for name in ("offsets", "states", "counts"))
    if offsets[0] != 0 or offsets[-1] != len(states) or len(states) != len(seen):
        return f"successor_offsets does not go from 0 to the {len(states)} successors"
    if (np.diff(offsets) < 0).any():
        return "successor_offsets decreases"
    some = np.diff(offsets) > 0
    whole = seen.dtype.kind == "i"
    sums = np.zeros(len(some), np.int64 if whole else np.float64)
    if some.any():
        sums[some] = np.add.reduceat(seen, offsets[:-1][some], dtype=sums.dtype)
    visits = arrays["visits"].ravel()
    if (sums != visits).any() if whole else not np.allclose(sums, visits, rtol=ROUNDING, atol=ROUNDING):
        return "successor_counts do not sum to visits"
    return None
