"""`run`, `train`, `eval` and `validate` on a tiny config, and what they say when something is wrong."""

import json
import os
import resource
import shutil
import stat
import subprocess

import numpy as np
import pytest

from tests.program import COMMAND, TINY, hashes, the_run, visitlab
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.console.running import held_run
from visitlab_cli.errors import RunError
from visitlab_cli.storage.arrays import read_model, read_trials
from visitlab_cli.storage.locks import RUN_LOCK, lock

EXPECTING = """
expected:
  navigation/chance: {{value: {value}, tolerance: 0.5}}
"""
ONE_CELL = "experiments={navigation: {task: navigation, agents: [mf], steps: 40}}"


@pytest.fixture
def run(tiny_run, tmp_path):
    """A copy of the tiny run that a test may change."""
    shutil.copytree(tiny_run, tmp_path / "runs" / tiny_run.name)
    return tmp_path / "runs" / tiny_run.name


def told(done):
    """The last line on stderr, which says what is wrong."""
    return done.stderr.splitlines()[-1]


def test_what_a_cell_leaves(tiny_run):
    cell = tiny_run / "social" / "mb" / "fast" / "seed-0000"
    assert sorted(file.name for file in cell.iterdir()) == [
        "cell.json",
        "model.npz",
        "steps.mcap",
        "timing.json",
        "trials.parquet",
    ]
    facts, rewards = json.loads((cell / "cell.json").read_text()), read_trials(cell / "trials.parquet")
    assert facts["cell"] == "social/mb/fast/seed-0000"
    assert facts["steps"] == 1200
    assert facts["mean_reward_last_tenth"] == rewards["reward"][-6:].mean()
    assert facts["files"]["model.npz"]["size"] == (cell / "model.npz").stat().st_size
    model = read_model(cell / "model.npz")
    assert model["q"].shape == (2560, 30)
    assert model["visits"].sum() == model["successor_counts"].sum() == 1200
    assert model["successor_offsets"][-1] == len(model["successor_states"])
    assert model["reward_sums"].sum() == rewards["reward"].sum()
    assert model["random_state"].shape == (4,)
    visit = read_trials(tiny_run / "visit" / "fast" / "seed-0000" / "trials.parquet")
    assert list(visit) == ["trial", "reward", "goals"]
    assert visit["trial"].tolist() == [0, 1, 2, 3]


def test_running_again_does_only_what_is_missing(run):
    times = {file: file.stat().st_mtime_ns for file in run.rglob("cell.json")}
    expected = hashes(run)
    missing = [run / "social" / "mf" / "fast", run / "visit" / "slow"]
    shutil.rmtree(missing[0])
    (missing[1] / "seed-0000" / "model.npz").write_bytes(b"cut short")
    (run / ".tmp-left-behind").mkdir()
    os.utime(run / ".tmp-left-behind", (1, 1))
    done = visitlab("run", TINY, "--out", run.parent)
    assert "2 of 17 cells to do" in done.stderr
    assert hashes(run) == expected
    again = {file: file.stat().st_mtime_ns for file in run.rglob("cell.json")}
    changed = {file.parents[1] for file in again if again[file] != times[file]}
    assert changed == set(missing)
    third = visitlab("run", TINY, "--out", run.parent)
    assert third.stderr == ""
    assert third.stdout == done.stdout


def test_train_then_eval_is_run(tiny_run, tmp_path):
    assert visitlab("train", TINY, "--out", tmp_path).returncode == 0
    run = the_run(tmp_path)
    assert not (run / "visit").exists()
    assert visitlab("eval", run, "--workers", 1).returncode == 0
    assert hashes(run) == hashes(tiny_run)


def test_eval_with_options_lies_beside(run):
    before = hashes(run)
    done = visitlab("eval", run, "--human", "fast_pointing", "--trials", 2, "--frozen", "--json")
    assert done.returncode == 0, done.stderr
    names = [line["name"] for line in json.loads(done.stdout)["results"]]
    assert len(names) == 2
    assert all(name.startswith("evaluations/") and name.endswith("/fast_pointing") for name in names)
    cell = run / names[0] / "seed-0000"
    assert len(read_trials(cell / "trials.parquet")["goals"]) == 2
    trained = read_model(run / "social" / "mb" / "fast" / "seed-0000" / "model.npz")["q"]
    assert np.array_equal(read_model(cell / "model.npz")["q"], trained)
    after = hashes(run)
    assert {path: after[path] for path in before} == before


def test_eval_wants_trained_modules(run):
    shutil.rmtree(run / "navigation" / "rmax")
    done = visitlab("eval", run, "--trials", 2)
    assert done.returncode == 4
    what, how = "navigation/rmax/seed-0000", f"visitlab train {run}/config.yaml --out {run.parent}"
    assert told(done) == f"{run}: not trained yet: {what}; train it with {how}"


@pytest.mark.parametrize(("value", "code"), [(0.0, 4), (None, 0)])
def test_an_expected_value_that_is_missed_exits_with_4(tiny_run, tmp_path, value, code):
    facts = json.loads((tiny_run / "navigation" / "chance" / "seed-0000" / "cell.json").read_text())
    reached = facts["mean_reward_last_hundredth"]
    assert reached > 1
    config = tmp_path / "expecting.yaml"
    config.write_text(TINY.read_text() + EXPECTING.format(value=reached if value is None else value))
    done = visitlab("train", config, "--out", tmp_path / "runs")
    assert done.returncode == code
    assert ("MISSED" in done.stdout) == (code == 4)
    if code:
        assert told(done) == "not within the tolerance of what the config expects: navigation/chance"
        other = visitlab("train", config, "agents.mf.alpha=0.4", "--out", tmp_path / "other")
        assert other.returncode == 0
        assert "difference" not in other.stdout


UNREACHABLE = [
    (
        "navigation/chance: {value: 1, tolerance: 1, trials: [50, 61]}",
        "navigation/chance.trials: up to 61, but there are 60",
    ),
    ("visit/slow: {value: 1, tolerance: 1, trials: [1, 5]}", "visit/slow.trials: up to 5, but there are 4"),
]


@pytest.mark.parametrize("words", [["validate"], ["train", "--out"], ["submit", "--slurm", "--out"]])
@pytest.mark.parametrize(("line", "told_of"), UNREACHABLE)
def test_an_expected_value_that_can_never_be_checked_is_refused_with_its_place(tmp_path, words, line, told_of):
    config = tmp_path / "expecting.yaml"
    config.write_text(f"{TINY.read_text()}\nexpected:\n  {line}\n")
    command, *options = words
    done = visitlab(command, config, *options, *([tmp_path / "runs"] if options else []))
    place = f"{config}:{len(TINY.read_text().splitlines()) + 3}:{line.index('[') + 3}"
    assert (done.returncode, done.stderr) == (3, f"{place}: expected.{told_of}\n")
    assert not (tmp_path / "runs").exists()


def test_expected_values_stay_with_the_run_and_follow_the_config(tmp_path):
    config, out = tmp_path / "expecting.yaml", tmp_path / "runs"
    config.write_text(TINY.read_text() + EXPECTING.format(value=0))
    assert visitlab("train", config, ONE_CELL, "--out", out).returncode == 0
    for value in (3, 5):
        config.write_text(TINY.read_text() + EXPECTING.format(value=value))
        visitlab("train", config, "--out", out)
        (stored,) = (file for file in out.glob("*/config.yaml") if "tolerance" in file.read_text())
        assert f"value: {value}.0" in stored.read_text()
    visitlab("train", config, "agents.mf.gamma=0.9", "--out", out)  # the default: the same run
    assert "value: 5.0" in stored.read_text()


def test_names_that_look_like_folders_of_seeds_are_kept_apart(tmp_path):
    config = tmp_path / "names.yaml"
    config.write_text(
        "name: names\nagents: {chance: {kind: random}}\n"
        "humans: {model-0000: {p_S: [1, 0, 0]}, seed-0000: {p_S: [0, 1, 0]}}\n"
        "experiments: {seed-1: {task: social, agents: [chance], humans: [model-0000, seed-0000], steps: 40}}\n"
    )
    done = visitlab("run", config, "--out", tmp_path / "runs", "--json")
    names = [line["name"] for line in json.loads(done.stdout)["results"]]
    assert names == ["seed-1/chance/model-0000", "seed-1/chance/seed-0000"]


def test_a_name_goes_before_longer_ones_that_begin_so(tmp_path):
    out = tmp_path / "runs"
    for name in ("one", "oneself"):
        assert visitlab("train", TINY, ONE_CELL, f"name={name}", "--out", out).returncode == 0
    done = visitlab("eval", "one", "--out", out)
    assert "its config declares no visit" in done.stderr
    assert "/one-" in done.stderr
    assert "several runs begin so" in visitlab("eval", "on", "--out", out).stderr


def test_names_that_cannot_be_files_are_not_found(tmp_path):
    for arguments in (["run", "a" * 300], ["eval", "a" * 300], ["replay", "a" * 300 + ".mcap"]):
        done = visitlab(*arguments, cwd=tmp_path)
        assert (done.returncode, len(done.stderr.splitlines())) == (5, 1), done.stderr


def test_too_much_memory_is_one_line(tmp_path):
    huge = "experiments={navigation: {task: navigation, agents: [mf], steps: 1000000000000}}"
    done = visitlab("train", TINY, huge, "record.steps=none", "--out", tmp_path, preexec_fn=little_memory)
    assert done.returncode == 4
    assert "Traceback" not in done.stderr


def little_memory():
    resource.setrlimit(resource.RLIMIT_AS, (8 * 2**30, resource.RLIM_INFINITY))


@pytest.mark.parametrize("arguments", [["--help"], ["validate", TINY], ["run", "--help"]])
def test_a_reader_that_leaves_early_is_no_failure(arguments):
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([*COMMAND, *map(str, arguments)], stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert done.stderr == b""
    assert done.returncode == 0


def test_losing_who_reads_the_progress_stops_nothing(tiny_run, tmp_path):
    reader, writer = os.pipe()
    os.close(reader)
    command = [*COMMAND, "run", str(TINY), "--out", str(tmp_path)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=writer, check=False)
    os.close(writer)
    assert done.returncode == 0
    assert hashes(the_run(tmp_path)) == hashes(tiny_run)


def test_validate_says_what_would_run(tmp_path):
    done = visitlab("validate", TINY)
    assert done.returncode == 0
    assert done.stdout == "valid: 17 cells, 18,000 steps; the run would be tiny-54e75efa\n"
    assert json.loads(visitlab("validate", TINY, "--json").stdout)["cells"] == 17


SHIPPED = ", ".join(name for name in shipped_configs() if "/" not in name)
BAD = [
    (
        ["run", "nope.yaml"],
        5,
        f"nope.yaml: no such file, nor a shipped config; shipped: {SHIPPED} and those in beyond/ and paper/",
    ),
    (["run", "quickstrat"], 5, "quickstrat: no such file, nor a shipped config; did you mean quickstart?"),
    (["run", TINY, "sedes=2"], 3, "override 'sedes=2': sedes: unknown; did you mean seeds?"),
    (["run", TINY, "humans.slow.p_M=2"], 3, "override 'humans.slow.p_M=2': humans.slow.p_M: must be at most 1 (got 2)"),
    (["eval", "latest"], 5, "latest: no such run in runs"),
    (["eval", "tiny-0"], 5, "tiny-0: no such run in runs"),
]


@pytest.mark.parametrize(("arguments", "code", "line"), BAD)
def test_bad_input_is_one_line(tmp_path, arguments, code, line):
    done = visitlab(*arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (code, "", line + "\n")
    assert not list(tmp_path.iterdir())


def test_an_undeclared_human_is_named(tiny_run):
    done = visitlab("eval", tiny_run, "--human", "fst")
    line = "--human fst: the run's config declares no such human; did you mean fast?"
    assert (done.returncode, told(done)) == (5, line)


def test_a_folder_that_cannot_be_made(tmp_path):
    (tmp_path / "file").touch()
    done = visitlab("run", TINY, "--out", tmp_path / "file")
    assert done.returncode == 4
    assert done.stderr.startswith(f"{tmp_path / 'file'}/tiny-")
    assert done.stderr.endswith("can't be written: Not a directory\n")


def test_a_start_that_fails_leaves_no_run(tmp_path):
    config, runs = load(TINY), tmp_path / "runs"
    with pytest.raises(RunError, match="no scheduler"), held_run(runs, config, print):
        raise RunError("no scheduler")
    assert list(runs.iterdir()) == []
    with held_run(runs, config, print) as (run, _):
        pass
    with pytest.raises(RunError, match="no scheduler"), held_run(runs, config, print):
        raise RunError("no scheduler")
    assert list(runs.iterdir()) == [run]


def test_a_start_that_fails_leaves_what_others_have_begun(tmp_path):
    config = load(TINY)
    with pytest.raises(RunError, match="no scheduler"), held_run(tmp_path, config, print) as (run, _):
        other = lock(run / RUN_LOCK, shared=True)
        raise RunError("no scheduler")
    other.release(remove=True)
    assert {path.name for path in run.iterdir()} == {"config.yaml", "versions.json"}


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_folder_that_must_not_be_written(tmp_path):
    tmp_path.chmod(stat.S_IRUSR | stat.S_IXUSR)
    done = visitlab("run", TINY, "--out", tmp_path)
    assert done.returncode == 4
    assert done.stderr.endswith("can't be written: Permission denied\n")


@pytest.mark.parametrize("workers", [1, 2])
def test_a_full_disk_leaves_nothing_half_written(tiny_run, tmp_path, workers):
    def little_room():
        resource.setrlimit(resource.RLIMIT_FSIZE, (40_000, resource.RLIM_INFINITY))

    done = visitlab("train", TINY, "--out", tmp_path, "--workers", workers, preexec_fn=little_room)
    assert done.returncode == 4
    assert "File too large" in told(done)
    run = the_run(tmp_path)
    assert not list(run.glob(".tmp-*"))
    cells = {file.parent for file in run.rglob("*") if file.is_file() and file.parent != run}
    assert all((cell / "cell.json").exists() for cell in cells)
    assert visitlab("run", TINY, "--out", tmp_path).returncode == 0
    assert hashes(run) == hashes(tiny_run)


def test_names_with_spaces_and_other_letters(tmp_path):
    out = tmp_path / "mes résultats à moi"
    done = visitlab("train", TINY, "--out", out, ONE_CELL)
    assert done.returncode == 0, done.stderr
    assert visitlab("eval", "tiny", "--out", out).returncode == 5


def test_no_home_and_no_terminal(tmp_path):
    environment = {"HOME": "", "XDG_CACHE_HOME": ""}
    done = visitlab("train", TINY, ONE_CELL, "--out", tmp_path, env=environment)
    assert done.returncode == 0, done.stderr


def test_version_and_help():
    assert visitlab("--version").stdout.strip().count(".") == 2
    assert visitlab("-h").returncode == 0
    assert "Did you mean 'run'" in visitlab("runn").stderr
