"""Whatever lies in a run folder, hashes right, is read or refused in one line: no crash, no memory, no traceback."""

import json
import multiprocessing
import os
import resource
import shutil
from functools import partial
from pathlib import Path

import pytest

from tests.storage import hostile
from visitlab_cli.config.loading import load
from visitlab_cli.errors import NotFoundError, RunError, VisitlabError
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import recorded_evaluations, unknown_evaluations
from visitlab_cli.plan.saved import model_of, modules_of, trials_of, unsound
from visitlab_cli.storage.arrays import read_model, read_trials
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.facts import FACTS, seconds_of
from visitlab_cli.storage.reading import open_file, parse_json
from visitlab_cli.storage.run_folder import read_config, read_versions
from visitlab_cli.storage.verify_cell import cell_faults

CELL = "social/mb/fast/seed-0000"
ROOM = 700 << 20
"""Bytes of address space beside what the program takes to start."""


@pytest.fixture
def run(tiny_run, tmp_path):
    return shutil.copytree(tiny_run, tmp_path / tiny_run.name)


def planned(run):
    return {cell.path: cell for cell in plan(load(run / "config.yaml"))}


def one_line(error):
    text = str(error)
    return text.isprintable() and "\n" not in text and len(text) < 900


def in_little_memory(send, run, names, made):
    """In a process of its own: each made file is refused in a line."""
    import pyarrow  # noqa: F401
    from numba import njit  # noqa: F401  (what the program maps before it reads anything)

    cells, wrong = planned(run), []
    read = {"model.npz": model_of, "trials.parquet": partial(trials_of, as_planned=True)}
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + ROOM, used + ROOM))
    for name in names:
        for what in sorted(path.name for path in (made / name).iterdir()):
            shutil.copy(made / name / what, run / CELL / name)
            hostile.restate(run / CELL)
            try:
                read[name](run, cells[CELL])
                wrong.append(f"{name}, {what}: accepted")
            except RunError as error:
                if not (one_line(error) and name in str(error)):
                    wrong.append(f"{name}, {what}: {error!r}")
            except BaseException as error:
                wrong.append(f"{name}, {what}: {error!r}")
    send.send(wrong)


@pytest.mark.parametrize(("name", "changes"), [("model.npz", hostile.MODELS), ("trials.parquet", hostile.TRIALS)])
def test_files_of_numbers_with_right_hashes_are_refused_in_a_line_and_little_memory(run, tmp_path, name, changes):
    whole = (run / CELL / name).read_bytes()
    (tmp_path / "made" / name).mkdir(parents=True)
    for what, change in changes.items():
        (tmp_path / "made" / name / what).write_bytes(change(whole))
    context = multiprocessing.get_context("spawn")
    receive, send = context.Pipe(duplex=False)
    child = context.Process(target=in_little_memory, args=(send, run, [name], tmp_path / "made"))
    child.start()
    send.close()
    try:
        wrong = receive.recv()
    except EOFError:
        wrong = []
    child.join()
    assert (child.exitcode, wrong) == (0, [])


def test_verify_finds_what_hashes_do_not_tell(run):
    cell = planned(run)[CELL]
    assert unsound(run, cell) is None
    file = run / CELL / "model.npz"
    file.write_bytes(hostile.MODELS["state outside"](file.read_bytes()))
    hostile.restate(run / CELL)
    assert cell_faults(run / CELL, CELL, cell.run_hash, cell.steps) == []
    name, problem = unsound(run, cell)
    assert (name, problem.split()[0]) == ("model.npz", "successor_states")


def test_verify_finds_a_log_that_says_that_it_is_another_cells(run):
    cell, other = planned(run)["visit/fast/seed-0000"], planned(run)["visit/slow/seed-0000"]
    shutil.copy(run / other.path / "steps.mcap", run / cell.path)
    hostile.restate(run / cell.path)
    assert cell_faults(run / cell.path, cell.path, cell.run_hash, cell.steps) == []
    problem = f"its metadata says cell {other.path!r}, not {cell.path}"
    assert unsound(run, cell) == ("steps.mcap", problem)
    assert not [path for path, each in planned(run).items() if each is not cell and unsound(run, planned(run)[path])][
        1:
    ]


def test_a_visit_does_not_start_from_a_model_that_is_not_its_modules(run):
    cells = planned(run)
    visit = cells["visit/fast/seed-0000"]
    assert set(modules_of(run, visit)) == {"navigation", "go_to_human", "social"}
    shutil.copy(run / CELL / "model.npz", run / visit.modules["go_to_human"] / "model.npz")
    with pytest.raises(RunError, match=r"go_to_human/.*model.npz: damaged: q is of kind"):
        modules_of(run, visit)


def test_every_kind_saves_what_it_declares(tiny_run):
    for cell in planned(tiny_run).values():
        saved = model_of(tiny_run, cell)
        assert saved.keys() == read_model(tiny_run / cell.path / "model.npz").keys(), cell.path
        assert all(array.flags.writeable and array.flags.c_contiguous for array in saved.values())


@pytest.mark.parametrize("key", [*FACTS, "files", "format", "sources"])
@pytest.mark.parametrize("value", hostile.VALUES.values(), ids=hostile.VALUES)
def test_no_cell_is_whole_whose_facts_can_not_be(run, key, value):
    file = run / CELL / "cell.json"
    facts = json.loads(file.read_text())
    if json.dumps(facts[key])[0] == value[0] == '"':
        return  # another text may be one
    whole = file.read_text()
    file.write_text(json.dumps(facts | {key: "@"}).replace('"@"', value))
    assert read_cell(run / CELL) is None
    found = cell_faults(run / CELL, CELL, None, None)
    assert found
    assert all(text.isprintable() for _, text in found)
    file.write_text(whole[:-2] + f', "{key}": 3}}')
    assert read_cell(run / CELL) is None, "the same key twice"


@pytest.mark.parametrize("value", hostile.VALUES.values(), ids=hostile.VALUES)
def test_timing_versions_and_options_that_can_not_be(run, value):
    (run / CELL / "timing.json").write_text(f'{{"seconds": {value}}}')
    assert seconds_of(run / CELL) is None
    if not value.startswith('"x'):
        (run / "versions.json").write_text(f'{{"visitlab": {value}}}')
        with pytest.raises(RunError, match=r"versions\.json: damaged"):
            read_versions(run)
    options = run / "evaluations" / "00000000"
    options.mkdir(parents=True)
    for key in ("humans", "trials", "frozen", "social"):
        told = {"humans": [], "trials": None, "frozen": False, "social": ""} | {key: "@"}
        (options / "evaluation.json").write_text(json.dumps(told).replace('"@"', value))
        assert (recorded_evaluations(run), unknown_evaluations(run)) == ([], ["evaluations/00000000"])


def replaced_by_link(file, tmp_path):
    file.rename(tmp_path / "outside")
    file.symlink_to(tmp_path / "outside")


OTHERS = {
    "a link": replaced_by_link,
    "a pipe": lambda file, tmp_path: (file.unlink(), os.mkfifo(file)),
    "a folder": lambda file, tmp_path: (file.unlink(), file.mkdir()),
}


@pytest.mark.parametrize("put", OTHERS.values(), ids=OTHERS)
def test_what_is_no_file_is_not_read_and_not_waited_for(run, tmp_path, put):
    read = {
        run / CELL / "model.npz": read_model,
        run / CELL / "trials.parquet": read_trials,
        run / "config.yaml": lambda file: read_config(file.parent),
        run / "versions.json": lambda file: read_versions(file.parent),
    }
    for file, reader in read.items():
        put(file, tmp_path)
        with pytest.raises(VisitlabError) as caught:
            reader(file)
        assert one_line(caught.value)
        assert not isinstance(caught.value, NotFoundError)
    for name in ("cell.json", "timing.json"):
        put(run / CELL.replace("mb", "mf") / name, tmp_path)
    assert seconds_of(run / CELL.replace("mb", "mf")) is None
    assert read_cell(run / CELL.replace("mb", "mf")) is None
    assert read_cell(run / CELL) is None, "its model is no file"


def test_files_are_bounded_though_they_be_sparse(run):
    for name in ("config.yaml", "versions.json"):
        os.truncate(run / name, 2**40)
        with pytest.raises(RunError):
            (read_config if name == "config.yaml" else read_versions)(run)
    for name, reader in (("model.npz", read_model), ("trials.parquet", read_trials)):
        os.truncate(run / CELL / name, 2**40)
        with pytest.raises(RunError, match="has more than"):
            reader(run / CELL / name)
    os.truncate(run / CELL / "cell.json", 2**40)
    assert read_cell(run / CELL) is None


def test_numbers_that_are_right_are_read():
    assert parse_json('{"a": [1, -2.5, 9223372036854775807, "\\u00e9", true, null]}') == {
        "a": [1, -2.5, 2**63 - 1, "é", True, None]
    }


def test_a_device_is_no_file():
    with pytest.raises(OSError, match="device"), open_file("/dev/zero"):
        pass
