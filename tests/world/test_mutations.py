"""The oracle judges: it must refuse the log of each wrong package, and accept that of the right one."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import visitlab_cli
from tests.oracle.checker import check_log
from tests.oracle.mutations import MUTATIONS, PHASES, SMALL, apply
from tests.program import copy_package
from tests.world.test_rules import contradictions, settings_of

PACKAGE = Path(visitlab_cli.__file__).parent
PLAYER = Path(__file__).with_name("package_log.py")
STEPS, LAB_STEPS = 6_000, 3_000
BEGINNING = 1_000
"""Rows that are looked at first, for most mutations show there."""


def is_refused(package: Path, folder: Path, task: str, labs: tuple[str, ...] = ()) -> bool:
    """Whether the oracle refuses a log of the package copied to `package`, played uncompiled in a new process."""
    steps = LAB_STEPS if labs else STEPS
    out = folder / "log.npz"
    environment = os.environ | {"PYTHONPATH": str(package.parent), "NUMBA_DISABLE_JIT": "1"}
    command = [sys.executable, str(PLAYER), task, str(steps), str(out), *(labs or [""])]
    subprocess.run(command, env=environment, check=True, cwd=folder)
    with np.load(out) as log:
        columns = dict(log)
    settings = settings_of(task, *labs, steps=steps)
    beginning = {name: values[:BEGINNING] for name, values in columns.items()}
    return bool(
        check_log(beginning, task, partial_last_trial=True, **settings) or contradictions(columns, task, **settings)
    )


@pytest.fixture
def copy(tmp_path):
    package = tmp_path / "visitlab_cli"
    copy_package(package)
    return package


def test_there_are_enough_of_them():
    assert len(MUTATIONS) >= 12


@pytest.mark.parametrize(
    ("task", "labs"),
    [
        *((task, ()) for task in ("navigation", "go_to_human", "social", "visit")),
        *((task, labs) for task in ("navigation", "go_to_human", "visit") for labs in (SMALL, PHASES)),
        ("navigation", ("corridor",)),
    ],
    ids=str,
)
def test_the_right_package_is_accepted(copy, tmp_path, task, labs):
    assert not is_refused(copy, tmp_path, task, labs)


IN_TURN = [
    pytest.param(mutation, id=mutation.name, marks=[pytest.mark.slow] if mutation.labs and number % 2 else [])
    for number, mutation in enumerate(MUTATIONS)
]
"""Of those in other labs, which take longer, every second one is for `make test-slow`."""


@pytest.mark.parametrize("mutation", IN_TURN)
def test_a_wrong_package_is_refused(copy, tmp_path, mutation):
    apply(mutation, copy)
    assert is_refused(copy, tmp_path, mutation.task, mutation.labs)
