"""Compiled code: one decorator for kernels, their cache folder, and dispatch on the type of a record.

A kernel is a plain function of arrays, scalars and NamedTuples of them. Its machine code is cached in a folder
named by a hash of every source file that kernels live in, since numba's own cache does not notice an edit in a
file that a kernel calls: an edited rule would silently run as before. What holds code of other packages lies in a
folder for just what they are, so that ours stays as it is.

Who calls a kernel holds the arrays that it works on, so ours count no references to them: for each array of each
record that goes from one function to another that would cost more than most rules do. So a kernel makes no arrays
and gives none back; `array_kernel` may, and code of others.

A kernel is called from Python, or by other kernels, and is compiled for each by itself: what takes records apart for
Python is a third of compiling, and most kernels are only ever called by others.
"""

import hashlib
import platform
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, TypeVar, cast

import llvmlite
import llvmlite.binding
import numba
from numba.core import types
from numba.extending import overload, register_jitable

from visitlab_cli.kernel_cache import CacheByCode, Place, place
from visitlab_cli.sources import digest_of, files_of, is_others, others

Function = TypeVar("Function", bound=Callable[..., Any])

KERNEL_SOURCES = (
    "callbacks.py",
    "compiled.py",
    "gym/episodes.py",
    "kernel_cache.py",
    "random_numbers.py",
    "world",
    "humans",
    "agents",
    "simulation",
)
_UNCOUNTED: Any = {"_nrt": False, "no_cfunc_wrapper": True}
"""How numba compiles what counts no references, and is never called by C."""
_settings: Any = numba.config
JIT_DISABLED = bool(_settings.DISABLE_JIT)
_registered: dict[type, list[Callable[..., Any]]] = {}
"""What operations do for each record."""


@cache
def sources_hash() -> str:
    """16 hex digits: every kernel source, and what else decides the machine code."""
    digest = digest_of(files_of(KERNEL_SOURCES))
    makers = (sys.version, platform.machine(), numba.__version__, llvmlite.__version__)
    processor = (llvmlite.binding.get_host_cpu_name(), llvmlite.binding.get_host_cpu_features().flatten())
    digest.update("\0".join(makers + processor).encode())
    return digest.hexdigest()[:16]


@cache
def cache_place(others: str = "") -> Place:
    """Where this version's machine code is kept, or why nowhere; that which holds code of `others`, a hash, apart."""
    both = f"{sources_hash()} {others}".encode()
    return place(f"kernels-{hashlib.sha256(both).hexdigest()[:16] if others else sources_hash()}")


def cache_folder() -> Path | None:
    """The folder of this version's machine code, which is ours alone; None where there is none."""
    return cache_place().folder


def place_of(records: Iterable[type], function: Callable[..., Any] | None = None) -> Place:
    """Where machine code is kept that is compiled for some records: apart where it holds others' code.

    What others have written comes in by the records that it is registered for, or is the `function` itself.
    """
    if not with_others(records) and not (function and is_others(function.__code__.co_filename)):
        return cache_place()
    whose = others()
    return Place(None, "code without a file takes part") if whose is None else cache_place(whose)


def with_others(records: Iterable[type]) -> bool:
    """Whether code of others is registered for one of some records."""
    registered = [each for record in records for each in _registered.get(record, ())]
    return any([is_others(each.__code__.co_filename) for each in registered])  # of all, for each is noted then


def records_in(given: Any) -> Iterator[type]:
    """The classes of the NamedTuples in values, or in numba's types of them, those of records held in memory, too."""
    if isinstance(given, types.BaseNamedTuple):
        yield given.instance_class  # type: ignore[attr-defined]
    elif isinstance(given, tuple):
        yield type(given)
    parts: Any = given if isinstance(given, tuple | types.BaseTuple) else ()
    if isinstance(given, types.StructRef):
        parts = [field for _, field in given._fields]
    for inner in parts:
        yield from records_in(inner)


def kernel(function: Function) -> Function:
    """Compile `function` on its first call, release the GIL in it, and keep its machine code in our cache."""
    return _kernel(function, forceinline=True)  # else records are copied at each call


def long_kernel(function: Function) -> Function:
    """A kernel that runs long at a call, and stays a function of its own: among a loop's own code it is slower."""
    return _kernel(function, forceinline=False)


def array_kernel(function: Function) -> Function:
    """A long kernel that may make arrays, and keep or give back records that hold some: it counts references."""
    return _kernel(function, forceinline=False, counts=True)


def _kernel(function: Function, forceinline: bool, counts: bool = False) -> Function:
    counts = is_others(function.__code__.co_filename) or counts
    options = {**_UNCOUNTED, "nogil": True, "forceinline": forceinline, "_nrt": counts}
    dispatcher = _cached(function, "", options)
    if not JIT_DISABLED:
        inner = _cached(function, ".inner", {**options, "no_cpython_wrapper": True})
        dispatcher.get_call_template, dispatcher.get_overload = inner.get_call_template, inner.get_overload
    return cast(Function, dispatcher)


def _cached(function: Callable[..., Any], ending: str, options: dict[str, Any]) -> Any:
    """A function as numba compiles it by `options`, kept in files of this ending."""
    compiler: Any = numba.njit
    dispatcher = compiler(**options)(function)
    if not JIT_DISABLED:
        dispatcher._cache = CacheByCode(function, ending, lambda given: place_of(records_in(given), function).folder)
    return dispatcher


class Operation:
    """A kernel chosen by the type of its first argument, a NamedTuple: how a loop meets its agent and task.

    `operation.of(Record)` registers the kernel for a record; `operation.function` is what kernels call. The
    choice is made while compiling, so it costs nothing in a loop, and the machine code can be cached (a kernel
    passed as an argument can't). With the compiler switched off the same table is consulted at each call.
    """

    def __init__(
        self,
        signature: Function,
        otherwise: Callable[..., Any] | None = None,
        check: Callable[..., None] | None = None,
    ) -> None:
        """Make an operation with the arguments of `signature`, a function without a body.

        Where nothing is registered for a record it is `otherwise`, if that is given. What a function of others
        answers goes to `check`, after the arguments, which raises where it is none; ours are not asked.
        """
        table: dict[type, Callable[..., Any]] = {} if otherwise is None else defaultdict(lambda: otherwise)
        self._otherwise, self._check = otherwise, check
        self._table = table
        self._called = table if check is None else {}  # from Python
        names = ", ".join(signature.__code__.co_varnames[: signature.__code__.co_argcount])
        first = names.split(",")[0]
        # numba matches an overload to the generic function by its argument names, so both are written out
        scope: dict[str, Any] = {"table": self._called, "find": self._find}
        exec(
            f"def {signature.__name__}({names}):\n    return table[type({first})]({names})\n"
            f"def choice({names}):\n    return find({first})\n",
            scope,
        )
        self._names = names
        self.function: Callable[..., Any] = scope[signature.__name__]
        self.function.__doc__ = signature.__doc__
        operations[self.function] = self
        # annotations may differ, names may not
        overload(self.function, strict=False, jit_options=_UNCOUNTED)(scope["choice"])

    def _find(self, first: Any) -> Callable[..., Any] | None:
        record = first.instance_class if isinstance(first, types.BaseNamedTuple) else None  # type: ignore[attr-defined]
        found = self._table.get(record, self._otherwise) if record else None
        if found is None or not is_others(found.__code__.co_filename):
            return found
        return self._calling(kernel(found), self._check and kernel(self._check))

    def _calling(self, function: Callable[..., Any], check: Callable[..., None] | None) -> Callable[..., Any]:
        """A function that calls one of others, which is compiled as theirs, not as ours, and checks its answer."""
        scope: dict[str, Any] = {"function": function, "check": check}
        checking = f"    check({self._names}, answer)\n" if check else ""
        exec(f"def call({self._names}):\n    answer = function({self._names})\n{checking}    return answer\n", scope)
        return cast(Callable[..., Any], scope["call"])

    def plain(self, record: type) -> Callable[..., Any]:
        """What it is for a record: the function as it was registered."""
        return self._table[record]

    def of(self, record: type) -> Callable[[Function], Function]:
        """Decorator: this plain function is the operation for `record`."""

        def register(function: Function) -> Function:
            theirs = is_others(function.__code__.co_filename)
            self._table[record] = function
            if self._check is not None:
                self._called[record] = self._calling(function, self._check) if theirs else function
            _registered.setdefault(record, []).append(function)
            return function

        return register


class Precaution(Operation):
    """An operation for what others have written: where none of their code takes part in the record it is nothing."""

    def __init__(self, function: Callable[..., Any]) -> None:
        """What is done where some takes part; from Python it is always done."""
        super().__init__(function, otherwise=function)
        scope: dict[str, Any] = {}
        exec(f"def nothing({self._names}):\n    pass\n", scope)
        self._nothing = scope["nothing"]

    def _find(self, first: Any) -> Callable[..., Any] | None:
        return self._otherwise if with_others(records_in(first)) else self._nothing


operations: dict[Callable[..., Any], Operation] = {}
"""Each by its function."""


def written(name: str, arguments: str, lines: Iterable[str], **names: Any) -> Callable[..., Any]:
    """A kernel whose text follows from a table; it is compiled into those that call it.

    Args:
        name: of the function.
        arguments: as in its `def` line.
        lines: of its body, not indented.
        names: what the lines refer to.
    """
    body = "".join(f"    {line}\n" for line in lines)
    exec(f"def {name}({arguments}):\n{body}", names)
    return cast(Callable[..., Any], register_jitable(forceinline=True, **_UNCOUNTED)(names[name]))
