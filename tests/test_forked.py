"""A call in a fork is what the program is as a process of its own; what is about imports never is in a fork."""

import os

import pytest

from tests.forked import can_fork, run_forked
from tests.program import TINY, new_process, visitlab

linux = pytest.mark.skipif("not __import__('sys').platform.startswith('linux')", reason="forks are tried on Linux")
HERE = os.environ | {"NO_COLOR": "1", "COLUMNS": "200"}


@linux
@pytest.mark.parametrize(
    ("words", "code"),
    [
        (["validate", "tiny.yaml"], 0),
        (["runn"], 2),
        (["run", "nöpe.yaml"], 5),
        (["validate", "tiny.yaml", "\udcff=1"], 3),
    ],
)
def test_it_prints_and_ends_as_a_process_of_its_own(words, code):
    forked, own = run_forked(words, TINY.parent, HERE), new_process(*words, cwd=TINY.parent)
    assert forked.returncode == code
    assert [forked.returncode, forked.stdout, forked.stderr] == [own.returncode, own.stdout, own.stderr]


@linux
def test_a_fork_leaves_nothing_to_the_next(tmp_path):
    (tmp_path / "mine.py").touch()  # no plug-in
    words = ["validate", str(TINY), "--plugin", "mine.py"]
    assert [run_forked(words, place, HERE).returncode for place in (tmp_path, TINY.parent, tmp_path)] == [3, 5, 3]


@linux
def test_other_variables_are_for_a_process_of_its_own(tmp_path):
    assert can_fork(HERE)
    assert can_fork(HERE | {"VISITLAB_CACHE": str(tmp_path)})
    for name in ("NUMBA_DISABLE_JIT", "HOME", "LC_ALL", "PYTHONHASHSEED", "MPLBACKEND", "TMPDIR", "PYTHONPATH"):
        assert not can_fork(HERE | {name: str(tmp_path)}), name
    assert visitlab("optimum", env={"NUMBA_DISABLE_JIT": "perhaps"}).returncode == 2
