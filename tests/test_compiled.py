"""Kernels that count no references: they give back no arrays, which nobody would hold."""

import importlib
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import numpy as np
import pytest

import visitlab_cli
from visitlab_cli.compiled import JIT_DISABLED, KERNEL_SOURCES, kernel, operations
from visitlab_cli.sources import files_of, is_others

ROOT = Path(visitlab_cli.__file__).parent


def compiled():
    """Each kernel of ours that counts no references, and each rule that an operation calls, as plain functions."""
    for file in files_of(KERNEL_SOURCES):
        module = importlib.import_module(".".join(("visitlab_cli", *file.relative_to(ROOT).with_suffix("").parts)))
        for value in vars(module).values():
            if hasattr(value, "py_func") and value.targetoptions["_nrt"] is False:
                yield value.py_func
    for operation in operations.values():
        yield from (rule for rule in operation._table.values() if not is_others(rule.__code__.co_filename))


def holds_arrays(hint):
    fields = get_type_hints(hint).values() if hasattr(hint, "_fields") else get_args(hint)
    return hint is Any or np.ndarray in (hint, get_origin(hint)) or any(map(holds_arrays, fields))


@pytest.mark.skipif(JIT_DISABLED, reason="nothing is compiled")
def test_what_counts_no_references_gives_back_no_arrays():
    rules = {function.__qualname__: get_type_hints(function).get("return") for function in compiled()}
    assert rules
    assert [name for name, hint in rules.items() if hint is None or holds_arrays(hint)] == []


def test_a_kernel_is_compiled_for_python_where_python_calls_it_only():
    @kernel
    def doubled(number):
        return 2 * number

    @kernel
    def six_times(number):
        return 3 * doubled(number)

    assert six_times(7) == 42
    assert JIT_DISABLED or not doubled.signatures
    assert doubled(7) == 14
    assert six_times(0.5) == 3.0
    assert JIT_DISABLED or (len(six_times.signatures), len(doubled.signatures)) == (2, 1)
