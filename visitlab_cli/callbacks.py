"""Python functions that compiled code calls, by their addresses: numbers, so that what calls them can be cached.

The call takes the GIL, which a kernel does without, for as long as it lasts. An address is good for as long as its
`Callback` is kept.
"""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from visitlab_cli.compiled import JIT_DISABLED

Number = type[int] | type[float]

_FORMS: dict[Number, tuple[Any, Any, Any]] = {
    int: (ctypes.c_int64, types.int64, ir.IntType(64)),
    float: (ctypes.c_double, types.float64, ir.DoubleType()),
}


class Signature:
    """What goes to a callback: whole numbers and floats; what comes back is a whole number."""

    def __init__(self, *arguments: Number) -> None:
        """Of the types `int` and `float`."""
        forms = [_FORMS[argument] for argument in arguments]
        self._function = ctypes.CFUNCTYPE(ctypes.c_int64, *(form for form, _, _ in forms))
        self._typed = types.int64(types.int64, *(form for _, form, _ in forms))
        self._called = ir.FunctionType(ir.IntType(64), [form for _, _, form in forms])

    def address(self, function: Callable[..., int]) -> "Callback":
        """Make a function one that kernels can call; it must not raise."""
        return Callback(self._function(function))

    def caller(self) -> Any:
        """What calls from a kernel, or from Python: `caller(address, *arguments)`."""
        if JIT_DISABLED:
            return lambda address, *arguments: self._function(address)(*arguments)
        return _intrinsic(len(self._typed.args), self._typed, self._called)


class Callback:
    """A Python function as machine code; `address` is where."""

    def __init__(self, function: Any) -> None:
        """Of ctypes' making."""
        self._kept = function
        self.address = int(ctypes.cast(function, ctypes.c_void_p).value or 0)


def _intrinsic(count: int, typed: Any, called: Any) -> Any:
    def generate(context: Any, builder: Any, signature: Any, arguments: Sequence[Any]) -> Any:
        pointer = builder.inttoptr(arguments[0], called.as_pointer())
        return builder.call(pointer, arguments[1:])

    names = ", ".join(f"value_{place}" for place in range(count))
    scope: dict[str, Any] = {"typed": typed, "generate": generate}
    exec(f"def call(typing, {names}):\n    return typed, generate\n", scope)
    return intrinsic(scope["call"])
