"""`visitlab runs` and `compare` of conditions as a user meets them."""

import contextlib
import io
import json
import os
import re
import shutil
import sys

import pytest

from tests.program import TINY, hashes, visitlab
from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.cli import main
from visitlab_cli.sources import CHECK_DIGITS, _checked, sources
from visitlab_cli.storage.cell_folder import to_json


def tell(*arguments, answer=None):
    """Run the program in this process: exit code, stdout, stderr."""
    streams = io.StringIO(), io.StringIO()
    before = sys.argv, sys.stdin
    sys.argv, sys.stdin = ["visitlab", *map(str, arguments)], io.StringIO(answer or "")
    code = 0
    try:
        with contextlib.redirect_stdout(streams[0]), contextlib.redirect_stderr(streams[1]):
            main()
    except SystemExit as end:
        code = end.code or 0
    finally:
        sys.argv, sys.stdin = before
    return code, *(stream.getvalue() for stream in streams)


def json_of(*arguments):
    code, out, err = tell(*arguments, "--json")
    assert code == 0, err
    return json.loads(out)


@pytest.fixture
def run(tiny_run, tmp_path):
    """A copy of the tiny run that a test may change."""
    return shutil.copytree(tiny_run, tmp_path / "runs" / tiny_run.name)


@pytest.fixture
def lab(tmp_path):
    """A run by hand with two agents, whose third seed is not run, in the folder `runs`."""
    run, cells = open_lab(tmp_path / "runs")
    values = {f"navigation/{agent}/seed-000{seed}": n + seed for agent, n in (("mb", 1), ("mf", 6)) for seed in (0, 1)}
    reach(run, cells, values)
    return run


def rows(table):
    return [re.split(r" {2,}", line.strip()) for line in table.splitlines()]


def test_list(lab):
    other, _ = open_lab(lab.parent, seed=1)
    (other / "config.yaml").write_text("[")
    os.utime(lab, (1, 1))
    code, out, err = tell("runs", "list", "--out", lab.parent)
    head, *lines = rows(out)
    assert code == 0
    assert head == ["name", "state", "cells", "seeds", "size", "age"]
    assert [line[:4] for line in lines] == [[other.name, "damaged", "-", "-"], [lab.name, "incomplete", "4/18", "3"]]
    assert lines[1][4].endswith(" kB")
    assert lines[1][5].endswith(" d")
    assert f"{other}/config.yaml:2:1: not YAML" in err
    told = json_of("runs", "list", "--out", lab.parent)["runs"]
    assert [(each["name"], each["state"], each["cells_done"]) for each in told] == [
        (other.name, "damaged", None),
        (lab.name, "incomplete", 4),
    ]


def test_list_of_nothing(tmp_path):
    assert tell("runs", "list", "--out", tmp_path) == (0, "", f"no runs in {tmp_path}\n")
    assert json_of("runs", "list", "--out", tmp_path / "none")["runs"] == []


def test_show(lab):
    code, out, err = tell("runs", "show", "lab", "--out", lab.parent)
    assert code == 0
    assert out.startswith(f"{lab}: incomplete, 4 of 18 cells, 3 seeds, ")
    table = {tuple(line[:3]): line[3:] for line in rows(out) if len(line) == 9}
    assert table["navigation", "mb", "-"] == ["reward a trial", "1.50 ± 6.35", "1.50", "2", "-", "2.0"]
    assert table["visit", "mb", "fast"] == ["goals a trial", "-", "-", "0", "-", "-"]
    assert err.startswith(f"{lab}: 14 of 18 cells not read: 14 not run yet (navigation/mb/seed-0002 and 13 more); ")
    told = json_of("runs", "show", lab, "--level", 0.6)
    assert (told["results"][0]["level"], told["results"][0]["steps_to_level"]) == (pytest.approx(0.9), 20)
    assert told["results"][0]["mean"] == 1.5
    assert told["results"][0]["interval"] == pytest.approx([1.5 - 6.353, 1.5 + 6.353], abs=1e-3)
    assert told["results"][-1]["interval"] is None


@pytest.mark.parametrize("level", ["0", "1.1", "nan"])
def test_show_wants_a_level(lab, level):
    assert tell("runs", "show", lab, "--level", level)[0] == 2


def test_diff(lab):
    vary = "vary: {agents.mf.alpha: [0.1, 0.5]}\n"
    other, _ = open_lab(lab.parent, name="other", seed=7, more=vary)
    (other / "versions.json").write_text('{"visitlab": "9", "python": "3"}')
    code, out, _ = tell("runs", "diff", "lab", "other", "--out", lab.parent)
    assert code == 0
    assert rows(out) == [
        ["what differs", lab.name, other.name],
        ["config", "name", '"lab"', '"other"'],
        ["config", "seed", "0", "7"],
        ["config", "vary.agents.mf.alpha", "missing", "[0.1, 0.5]"],
        ["versions", "visitlab", '"0"', '"9"'],
    ]
    told = json_of("runs", "diff", lab, other)
    assert told["config"][2] == {"path": "vary.agents.mf.alpha", "second": [0.1, 0.5]}
    assert told["versions"] == [{"path": "visitlab", "first": "0", "second": "9"}]
    assert tell("runs", "diff", lab, lab)[1] == f"{lab} and {lab}: the same config, versions and sources\n"


def test_diff_tells_which_code_made_the_cells(run):
    other = shutil.copytree(run, run.with_name("other-01234567"))
    theirs = _checked("0" * (len(sources()) - CHECK_DIGITS))
    for file in other.rglob("cell.json"):
        file.write_text(to_json(json.loads(file.read_text()) | {"sources": theirs}))
    code, out, _ = tell("runs", "diff", run, other)
    assert code == 0
    ((kind, what, first, second),) = rows(out)[1:]
    assert (kind, what, second) == ("cells", "sources", f'["{theirs}"]')
    assert json_of("runs", "diff", run, other)["cells"] == [
        {"path": "sources", "first": json.loads(first), "second": [theirs]}
    ]


def test_verify_names_it_and_running_again_mends_that_alone(run):
    expected = hashes(run)
    assert tell("runs", "verify", run) == (0, f"{run}: 17 of 17 cells are as they were written\n", "")
    damaged = ["navigation/rmax/seed-0000", "visit/slow/seed-0000"]
    for path, name in zip(damaged, ("model.npz", "trials.parquet"), strict=True):
        content = bytearray((run / path / name).read_bytes())
        content[100] ^= 1
        (run / path / name).write_bytes(content)
    (run / "versions.json").write_text("{")
    times = {file: file.stat().st_mtime_ns for file in run.rglob("cell.json")}
    before = hashes(run)
    code, out, err = tell("runs", "verify", run, "--dry-run")
    assert (code, hashes(run)) == (4, before)
    assert err == f"{run}: is damaged; nothing was changed\n"
    code, out, err = tell("runs", "verify", run)
    assert code == 4
    assert [line.partition(":")[0] for line in out.splitlines()] == [
        "versions.json",
        f"{damaged[0]}/model.npz",
        f"{damaged[1]}/trials.parquet",
        str(run),
    ]
    again = f"visitlab run {run}/config.yaml --out {run.parent}"
    assert err == f"{run}: what is damaged counts as missing now; mend it with {again}\n"
    done = visitlab(*again.split()[1:])
    assert done.returncode == 0, done.stderr
    assert "2 of 17 cells to do" in done.stderr
    assert {path: digest for path, digest in hashes(run).items() if not path.endswith(".damaged")} == expected
    changed = {file.parent.relative_to(run).as_posix() for file in times if file.stat().st_mtime_ns != times[file]}
    assert changed == set(damaged)
    assert tell("runs", "verify", run)[0] == 0


def test_verify_in_json_counts_what_is_not_run(run):
    shutil.rmtree(run / "visit")
    (run / "social/mf/fast/seed-0000/cell.json").unlink()
    code, out, _ = tell("runs", "verify", run, "--json")
    told = json.loads(out)
    assert (code, told["cells"], told["whole"]) == (4, 15, 14)
    assert told["not_run"] == ["visit/fast/seed-0000", "visit/slow/seed-0000"]
    assert told["faults"] == [{"cell": "social/mf/fast/seed-0000", "file": "cell.json", "problem": "missing"}]


def test_verify_of_an_edited_config(run):
    config = run / "config.yaml"
    config.write_text(config.read_text().replace("alpha: 0.5", "alpha: 0.25", 1))
    code, out, err = tell("runs", "verify", run)
    assert code == 4
    assert out.startswith("config.yaml: was edited: its hash is ")
    assert err == f"{config}: restore it, or delete it and run the config that it was made from\n"
    config.unlink()
    assert visitlab("run", TINY, "--out", run.parent, "-q").returncode == 0
    assert tell("runs", "verify", run)[0] == 0


def test_prune(run):
    (run / ".tmp-left-01234567").mkdir()
    os.utime(run / ".tmp-left-01234567", (1, 1))
    (run / "navigation/mf/seed-0000/cell.json").unlink()
    code, out, _ = tell("runs", "prune", run, "--dry-run")
    assert (code, out) == (0, "would remove .tmp-left-01234567\nwould remove navigation/mf/seed-0000\n")
    told = json_of("runs", "prune", run)
    assert (told["removed"], told["kept"]) == ([".tmp-left-01234567", "navigation/mf/seed-0000"], {})
    assert tell("runs", "prune", run)[1] == f"{run}: nothing to remove\n"
    assert not (run / "navigation/mf/seed-0000").exists()


def test_rm_asks(run):
    code, out, err = tell("runs", "rm", run)
    assert (code, out) == (2, "")
    assert re.search(r"Remove .*tiny-54e75efa \(17 cells, [\d.]+ .B\)\?", err)
    assert err.endswith("not removed; --yes removes without asking\n")
    assert tell("runs", "rm", run, answer="n\n")[:2] == (0, f"kept {run}\n")
    assert run.exists()
    code, out, _ = tell("runs", "rm", run, answer="y\n")
    assert (code, run.exists()) == (0, False)
    assert re.fullmatch(r"removed .*tiny-54e75efa \(17 cells, [\d.]+ .B\)\n", out)


def test_rm_without_asking_and_what_it_refuses(run, tmp_path):
    project = tmp_path / "project"
    project.mkdir()
    for name in ("config.yaml", "versions.json", "thesis.tex"):
        shutil.copy(run / "config.yaml", project / name)
    assert tell("runs", "rm", project, "--yes")[0] == 5
    assert len(list(project.iterdir())) == 3
    assert tell("runs", "rm", "", "--yes", "--out", run.parent)[0] == 2
    assert tell("runs", "rm", "nothing", "--yes", "--out", run.parent)[0] == 5
    told = json_of("runs", "rm", "latest", "--yes", "--out", run.parent)
    assert (told["removed"], told["run"], run.exists()) == (True, str(run), False)


def test_a_new_run_says_what_differs_from_the_nearest(run):
    code, _, err = tell("run", TINY, "agents.mf.alpha=0.4", "--out", run.parent, "--dry-run")
    line = rf"{run.parent}/tiny-[0-9a-f]{{8}}: a new run: unlike {run}, agents.mf.alpha is 0.4, not 0.5"
    assert code == 0
    assert re.fullmatch(line, err.splitlines()[0])
    assert "a new run" not in tell("run", TINY, "--out", run.parent, "--dry-run")[2]
    assert "a new run" not in tell("run", TINY, "agents.mf.alpha=0.4", "--out", run.parent, "--dry-run", "--quiet")[2]


def test_compare_by_agent(lab):
    code, out, _ = tell("compare", lab, "--by", "agent")
    assert code == 0
    pair = ["navigation", "reward a trial", "mb", "mf", "independent", "1.50", "6.50", "+5.00 ± 3.04", "2", "1.00"]
    assert rows(out)[1] == pair
    (told,) = json_of("compare", lab, "--by", "agent")["pairs"]
    assert (told["difference"], told["n"], told["probability_of_improvement"]) == (5.0, 2, 1.0)
    code, _, err = tell("compare", lab, "--by", "agents.mf.alpa")
    assert (code, err) == (5, "--by agents.mf.alpa: the run has no such key; known: agent, human, experiment\n")
    assert tell("compare", lab, lab, "--by", "agent")[0] == 2


def test_compare_two_runs(lab):
    other, cells = open_lab(lab.parent, name="other", more="interaction: {distances: [1, 2, 3, 5]}\n")
    reach(other, cells, {"navigation/mb/seed-0000": 2, "navigation/mb/seed-0001": 4})
    code, out, _ = tell("compare", "lab", "other", "--out", lab.parent)
    assert code == 0
    pair = [lab.name, other.name, "paired", "1.50", "3.00", "+1.50 ± 6.35", "2", "0.88"]
    assert rows(out)[1] == ["navigation/mb", "reward a trial", *pair]
    assert out.endswith(f"in {other.name} interaction.distances is [1, 2, 3, 5], not [1, 2, 4, 5]\n")
    told = json_of("compare", lab, other)
    assert told["config"] == [{"path": "interaction.distances", "first": [1, 2, 4, 5], "second": [1, 2, 3, 5]}]
    assert told["pairs"][0]["paired"] is True
