"""The tool that counts faults sees them: each of its checks fails where something is wrong."""

import random
import tomllib

import pytest

from tests.faults import readers
from tests.faults.__main__ import FAULTS, counted
from tests.faults.bench import Bench, Done
from tests.faults.fault import Fault, Try
from tests.faults.page import BLOCK, PAGE
from tests.lowest import PROJECT, lowest
from tests.program import hashes, only_cells
from visitlab_cli.errors import RunError


@pytest.fixture
def bench(tiny_run):
    bench = Bench(fast=True)
    bench.whole, bench.expected, bench.seconds = tiny_run, only_cells(hashes(tiny_run)), 1.0
    yield bench
    bench.close()


@pytest.fixture
def this(bench):
    return Try("a-class", 0, 0, bench)


def done(code=0, stderr="", stdout="", timed_out=False):
    return Done("visitlab x", code, stdout, stderr, 1.0, timed_out, 0)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (done(1, "a bug"), "not exit 4"),
        (done(0), "not exit 4"),
        (done(-11, ""), "not exit 4"),
        (done(4, ""), "without a word"),
        (done(4, "Traceback (most recent call last):\nx"), "shows"),
        (done(4, "cell: ValueError: x"), "shows"),
        (done(4, "UserWarning: x\nit failed"), "shows"),
        (done(4, "runs/x: can't be written: None"), "shows"),
        (done(4, "\x1b[31mred"), "control characters"),
        (done(4, "no reason"), "does not say"),
        (done(4, "x", timed_out=True), "hangs"),
    ],
)
def test_what_a_user_must_not_meet_is_wrong(this, wrong, said):
    assert not this.told(wrong, 4, names="disk")
    assert any(said in line for line in this.wrong), this.wrong


def test_one_clear_line_is_right(this):
    assert this.told(done(4, "runs/x: can't be written: the disk is full\n"), 4, names="disk")
    assert this.told(done(0, "", "a table"))
    assert this.wrong == []


CELL = "visit/fast/seed-0000"


@pytest.mark.parametrize(
    ("change", "lost", "wrong"),
    [
        (lambda run: None, 0, 0),
        (lambda run: (run / CELL / "model.npz").write_bytes(b"x"), 1, 1),
        (lambda run: (run / CELL / "model.npz").unlink(), 1, 1),
        (lambda run: (run / CELL / "cell.json").touch(), 1, 0),
        (lambda run: (run / ".tmp-cell-x").mkdir(), 0, 1),
        (
            lambda run: (
                (run / "visit" / "fast" / "seed-0001").mkdir() or (run / CELL.replace("0000", "0001/x")).touch()
            ),
            0,
            1,
        ),
    ],
)
def test_what_is_not_as_undisturbed_is_seen(this, change, lost, wrong):
    out = this.copy_of_whole()
    kept = this.finished(out)
    change(out / this.bench.whole.name)
    this.whole(out, kept)
    assert (len(this.lost), len(this.wrong)) == (lost, wrong), (this.lost, this.wrong)


def test_a_users_file_that_changed_is_lost(this):
    (this.folder / "other").write_text("mine")
    this.unchanged({"notes": b"mine"}, this.folder, "rm")
    assert (len(this.lost), len(this.wrong)) == (1, 1)


def test_a_check_that_breaks_or_came_too_late_is_no_success(bench):
    def too_late(this):
        this.count = 0

    def breaks(this):
        raise KeyError("x")

    chosen = [
        Fault("late", "", 2, 2, (), too_late),
        Fault("breaks", "", 2, 2, (), breaks),
        Fault("none", "", 2, 2, (), breaks),
    ]
    bench._missing["a planet"] = "there is none"
    chosen[2] = chosen[2]._replace(needs=("a planet",))
    late, broken, none = counted(chosen, 0, bench, None, 1)
    assert (late.tries, len(broken.wrong), none.tries, none.not_tried) == (0, 2, 0, "there is none")


def fails(error):
    def read():
        raise error

    return read


@pytest.mark.parametrize(
    "error",
    [
        KeyError("x"),
        MemoryError(),
        RecursionError(),
        RunError(""),
        RunError("a\nb"),
        RunError("\x1b[2J"),
        UserWarning("x"),
    ],
)
def test_a_reader_that_answers_otherwise_than_in_a_line_is_wrong(error):
    assert readers.judged("x", fails(error))[0]
    assert readers.judged("x", fails(RunError("damaged")))[0] == []
    assert readers.judged("x", lambda: 3) == ([], 3)


def test_recovered_rows_that_never_were_are_seen():
    whole = {"trial": readers.np.array([0, 0, 1]), "step": readers.np.array([0, 1, 0])}
    part = {name: values[1:] for name, values in whole.items()}
    assert readers._part_of(part, whole)
    assert not readers._part_of(part | {"step": part["step"] + 1}, whole)


def test_changes_change_and_are_the_same_for_the_same_seed():
    data = bytes(range(200))
    made = [readers.changed(data, random.Random(seed)) for seed in range(50)]
    assert made == [readers.changed(data, random.Random(seed)) for seed in range(50)]
    assert sum(each != data for each in made) > 40


def test_every_class_is_told_and_some_of_them_are_in_the_slice_for_ci():
    assert all(fault.about and fault.tries >= fault.fast for fault in FAULTS.values())
    assert sum(fault.fast for fault in FAULTS.values()) > 20
    assert BLOCK.search(PAGE.read_text())


def test_every_dependency_of_the_package_has_a_lower_bound():
    declared = tomllib.loads(PROJECT.read_text())["project"]["dependencies"]
    bounds = {line.partition("==")[0] for line in lowest()}
    assert {each.partition(">=")[0] for each in declared} <= bounds
