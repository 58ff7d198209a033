"""`submit`: the script that it writes is really run by bash, the queue is one that only keeps what it is told."""

import json
import os
import shlex
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from platformdirs import user_cache_path

from tests.jobs.queues import fake_visitlab, lines_of, program, queue
from tests.program import TINY, hashes, only_cells, the_run, visitlab
from visitlab_cli.jobs.packing import Job, Packing
from visitlab_cli.jobs.script import SLURM, Request, check

REQUEST = Request(SLURM, Path("runs/a-01234567"), 1, Packing(1, (Job(1, 1, 1.0),)), 1, 60, "visitlab", 1, 10, "again")
STRANGE = "runs with: 'quotes' \"two\" $HOME `id` %j ünï 迷 \\ -x"
CELLS = 17


@pytest.fixture
def out(tmp_path):
    return tmp_path / STRANGE


def submit(tmp_path, out, *words, does="", path=True):
    """The real program, with the queue of `tmp_path` and a visitlab that only notes what it is told."""
    called = shlex.join([str(fake_visitlab(tmp_path / "bin", does))])
    more = {"PATH": f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"} if path else {}
    return visitlab("submit", TINY, *words, "--out", out, "--command", called, cwd=tmp_path, env=more)


def calls(tmp_path):
    return lines_of(tmp_path / "bin" / "calls")


def shards(tmp_path):
    """The shards that were run, as `--shard` says them."""
    return [call["words"][call["words"].index("--shard") + 1] for call in calls(tmp_path)]


def told(done):
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ([], "--slurm, --pbs, --shell: choose one"),
        (["--slurm", "--pbs"], "--slurm, --pbs, --shell: choose one"),
        (["--slurm", "--go", "--dry-run"], "--go and --dry-run: choose one"),
        (["--slurm", "--cells-per-job", "some"], "--cells-per-job some: must be auto or a number from 1"),
        (
            ["--slurm", "--time", "1h"],
            "--time 1h: must be hours:minutes:seconds, such as 1:30:00, or days-hours:minutes",
        ),
        (["--slurm", "--time", "0:00:00"], "--time 0:00:00: must be"),
        (["--shell", "--time", "1:00:00"], "--time: is for a queue, and --shell has none"),
        (["--shell", "--memory", "4G"], "--memory: is for a queue, and --shell has none"),
        (["--slurm", "--partition", "a b"], "--partition a b: must be one plain word"),
        (["--slurm", "--memory", "lots"], "--memory lots: must be a number of K, M, G or T, such as 4G\n"),
        (["--slurm", "--memory", "4gb"], "--memory 4gb: must be a number of K, M, G or T, such as 4G\n"),
        (["--pbs", "--memory", "4.5gb"], "--memory 4.5gb: must be a number of kb, mb, gb or tb, such as 4gb\n"),
        (["--slurm", "--directive", "mail"], "--directive mail: must be an option of sbatch, such as --mail-type=END"),
        (["--pbs", "--directive", "--mail"], "--directive --mail: must be an option of qsub, such as '-m e'\n"),
        (
            ["--slurm", "--directive", "--mem=4G\ntouch x"],
            "--directive: must be one line; give the option once for each",
        ),
        (
            ["--slurm", "--cells-per-job", "1", "--jobs", "5"],
            "--cells-per-job 1 makes 17 jobs of 17 cells; --jobs 17 fits",
        ),
        (
            ["--slurm", "--time", "0:01:00"],
            "--time 0:01:00: the longest of 17 jobs would take 0:04:00, 3 minutes around",
        ),
        (["experiments.visit.trials=9999999", "--slurm"], "--time 1:00:00: the longest of 17 jobs would take 1"),
    ],
)
def test_what_can_not_be_is_one_line_and_leaves_nothing(words, line, tmp_path):
    done = visitlab("submit", TINY, *words, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(line)
    assert done.stderr.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("limit", [1000, 4, 3])
@pytest.mark.parametrize(("system", "handing_in"), [("slurm", "sbatch"), ("pbs", "qsub")])
def test_every_shard_is_run_once_whatever_the_arrays(system, handing_in, limit, tmp_path, out):
    queue(tmp_path / "bin", handing_in)
    words = [f"--{system}", "--cells-per-job", "3", "--array-limit", limit, "--workers", "2", "--go", "--json"]
    found = told(submit(tmp_path, out, *words))
    run, count, temporary = the_run(out), found["shards"], os.environ.get("TMPDIR", "/tmp")
    assert sorted(shards(tmp_path)) == sorted(f"{job['shard']}/{count}" for job in found["jobs"])
    assert sum(job["cells"] for job in found["jobs"]) == found["missing"] == found["cells"] == CELLS
    for call in calls(tmp_path):
        shard = call["words"][call["words"].index("--shard") + 1]
        expected = ["run", f"{run}/config.yaml", "seeds=1", "--out", str(out), "--shard", shard, "--workers", "2"]
        assert call["words"] == [*expected, "--quiet"]
        assert (call["OPENBLAS_NUM_THREADS"], call["NUMBA_NUM_THREADS"]) == ("1", "1")
        assert call["VISITLAB_CACHE"] == os.environ.get("VISITLAB_CACHE", f"{temporary}/visitlab-{os.getuid()}")
    handed = lines_of(tmp_path / "bin" / "told")
    assert len(handed) == len(found["submit"]) == len(found["submitted"]) == -(-len(found["jobs"]) // limit)
    assert found["submitted"] == [f"{i + 1}" if system == "slurm" else f"{i + 1}[].server" for i in range(len(handed))]
    assert (run / "jobs" / f"{system}.sh").is_file()
    logs = [file for file in (run / "jobs").iterdir() if file.suffix == ".log"]
    assert len(logs) == len(found["jobs"])
    assert all(f"shard {log.name.split('-')[1]} of {count} on" in log.read_text() for log in logs)


def test_slurm_is_asked_how_long_an_array_may_be(tmp_path, out):
    queue(tmp_path / "bin", "sbatch")
    program(tmp_path / "bin", "scontrol", "#!/bin/sh\necho 'MaxArraySize            = 5'\n")
    found = told(submit(tmp_path, out, "--slurm", "--cells-per-job", "3", "--json"))
    assert [command[1] for command in found["submit"]] == ["--array=0-4", "--array=0-0"]
    assert lines_of(tmp_path / "bin" / "told") == []


def test_what_the_queue_is_told(tmp_path):
    words = ["--partition", "short", "--account", "lab", "--memory", "4G", "--time", "1-02:00:00", "--workers", "3"]
    more = ["--directive", "--nice=10", "--directive", "--mail-type=END", "--prologue", "module load python"]
    visitlab("submit", TINY, "--slurm", *words, *more, cwd=tmp_path)
    script = the_run(tmp_path / "runs") / "jobs" / "slurm.sh"
    lines = script.read_text().splitlines()
    assert lines[0] == "#!/bin/bash"
    asked = [line.removeprefix("#SBATCH ") for line in lines if line.startswith("#SBATCH ")]
    assert {"--partition=short", "--account=lab", "--mem=4G", "--time=26:00:00", "--cpus-per-task=3"} < set(asked)
    assert {"--array=0-0", "--signal=B:TERM@60", "--requeue"} < set(asked)
    assert asked[-2:] == ["--nice=10", "--mail-type=END"]
    first = next(number for number, line in enumerate(lines) if line and not line.startswith("#"))
    assert lines[first] == "module load python"
    assert f"{sys.executable} -P -m visitlab_cli run" in script.read_text()


@pytest.mark.parametrize(
    ("system", "words"),
    [
        *(("slurm", ["--memory", memory]) for memory in ("4000", "0", "4G", "512m", "1T")),
        *(("pbs", ["--memory", memory]) for memory in ("4gb", "400MB", "1024kw", "4g", "4096")),
        *(("slurm", ["--directive", text]) for text in ("--nice=10", "-C haswell", "--exclusive", "--mail-user a@b.c")),
        *(("pbs", ["--directive", text]) for text in ("-m e", "-l place=excl", "-Wgroup_list=lab")),
    ],
)
def test_what_a_queue_understands_is_let_through(system, words):
    memory, directives = (words[1], ()) if words[0] == "--memory" else ("", (words[1],))
    check(REQUEST._replace(system=system, memory=memory, directives=directives))


def test_the_command_that_goes_on_is_not_the_one_that_only_tells(tmp_path):
    done = visitlab("submit", TINY, "--slurm", "--dry-run", "--json", "--memory", "4G", cwd=tmp_path)
    assert shlex.split(told(done)["again"])[2:] == ["&&", "visitlab", "submit", str(TINY), "--slurm", "--memory", "4G"]


def test_text_of_the_user_never_becomes_a_line_of_the_script(tmp_path):
    override = "humans.slow={p_S: [1, 0, 0],\n p_M: 0.2}\n"
    done = visitlab("submit", TINY, override, "--slurm", "--script", tmp_path / "job\ntouch pwned", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (script,) = tmp_path.glob("job*")
    head = script.read_text().split("\nrun=")[0]
    assert all(line.startswith("#") for line in head.splitlines() if line)


@pytest.mark.parametrize("system", ["slurm", "pbs", "shell"])
def test_bash_and_shellcheck_have_nothing_to_say(system, tmp_path, out):
    assert submit(tmp_path, out, f"--{system}", "--cells-per-job", "3").returncode == 0
    script = the_run(out) / "jobs" / f"{system}.sh"
    assert subprocess.run(["bash", "-n", script], capture_output=True, check=True).stderr == b""
    if (checker := Path(sys.executable).with_name("shellcheck")).exists():
        subprocess.run([checker, "--severity=warning", script], check=True)


SLOW = "time.sleep(0.4)"


def test_a_shell_runs_some_at_once(tmp_path, out):
    done = submit(tmp_path, out, "--shell", "--cells-per-job", "3", "--workers", os.cpu_count(), does=SLOW)
    assert done.returncode == 0, done.stderr
    script = the_run(out) / "jobs" / "shell.sh"
    subprocess.run(["bash", script], cwd="/", env=os.environ | {"AT_ONCE": "2"}, check=True)
    found = sorted(calls(tmp_path), key=lambda call: call["begun"])
    assert len(set(shards(tmp_path))) == len(found) > 3
    together = [sum(other["begun"] < call["begun"] < other["ended"] for other in found) for call in found]
    assert max(together) == 1
    assert all(call["VISITLAB_CACHE"] is None for call in found)
    subprocess.run(["bash", os.path.relpath(script, tmp_path), "2"], cwd=tmp_path, check=True)
    assert len(calls(tmp_path)) == len(found) + 1
    assert shards(tmp_path)[-1].startswith("2/")


@pytest.mark.parametrize(
    ("words", "at_once", "line"),
    [
        (["9"], "1", "9: no such shard; there are 1 2 3 4 5 6"),
        (["1 2"], "1", "1 2: no such shard; there are 1 2 3 4 5 6"),
        ([], "x", "AT_ONCE=x: must be a number of shards, from 1 on"),
        ([], "0", "AT_ONCE=0: must be a number of shards, from 1 on"),
    ],
)
def test_a_shell_script_is_asked_for_what_there_is_none_of(words, at_once, line, tmp_path, out):
    assert submit(tmp_path, out, "--shell", "--cells-per-job", "3").returncode == 0
    script = the_run(out) / "jobs" / "shell.sh"
    command, environment = ["bash", script, *words], os.environ | {"AT_ONCE": at_once}
    done = subprocess.run(command, env=environment, check=False, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", f"{script}: {line}\n")
    assert not list(script.parent.glob("*.log"))


def test_a_shard_that_fails_is_the_scripts_failure_and_the_others_run(tmp_path, out):
    fails = "if '2/' in sys.argv[sys.argv.index('--shard') + 1]: sys.exit(4)"
    done = submit(tmp_path, out, "--shell", "--cells-per-job", "3", "--go", does=fails)
    assert done.returncode == 4
    assert len(calls(tmp_path)) == 5


ASKED_TO_END = """
import signal
def end(*given):
    with (here / "asked").open("a") as asked:
        asked.write("x")
    time.sleep(0.3)
    os._exit(130)
signal.signal(signal.SIGTERM, end)
signal.signal(signal.SIGINT, end)
(here / f"begun-{os.getpid()}").touch()
time.sleep(60)
"""


def begun(tmp_path, count, process):
    until = time.monotonic() + 60
    while len(found := [*(tmp_path / "bin").glob("begun-*")]) < count and time.monotonic() < until:
        assert process.poll() is None
        time.sleep(0.05)
    return [int(file.name.split("-")[1]) for file in found]


def hear_ctrl_c():
    """A program that is started in the background ignores it, and so would the shell."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.mark.parametrize("to_all", [False, True])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_stopping_the_shell_asks_each_shard_to_end_once(number, to_all, tmp_path, out):
    assert submit(tmp_path, out, "--shell", "--cells-per-job", "3", does=ASKED_TO_END).returncode == 0
    variables = os.environ | {"AT_ONCE": "2"}
    script = the_run(out) / "jobs" / "shell.sh"
    process = subprocess.Popen(["bash", script], env=variables, start_new_session=True, preexec_fn=hear_ctrl_c)
    running = begun(tmp_path, 2, process)
    (os.killpg if to_all else os.kill)(process.pid, number)
    assert process.wait(timeout=30) == 130
    assert (tmp_path / "bin" / "asked").read_text() == "xx"
    for each in running:
        with pytest.raises(ProcessLookupError):
            os.kill(each, 0)
    assert len(begun(tmp_path, 2, process)) == 2


def test_the_signal_before_the_end_reaches_the_program(tmp_path, out):
    assert submit(tmp_path, out, "--slurm", does=ASKED_TO_END).returncode == 0
    script = the_run(out) / "jobs" / "slurm.sh"
    process = subprocess.Popen(["bash", script], env=os.environ | {"SLURM_ARRAY_TASK_ID": "0"})
    assert begun(tmp_path, 1, process) == [process.pid]
    process.send_signal(signal.SIGTERM)  # as --signal=B:TERM@60 does: to the shell alone
    assert process.wait(timeout=30) == 130
    assert (tmp_path / "bin" / "asked").read_text() == "x"


@pytest.mark.parametrize(
    ("queue_says", "line"),
    [
        (None, "sbatch: not on this machine; by hand: sbatch"),
        (
            "echo 'sbatch: error: x' >&2; echo 'sbatch: error: Batch job submission failed' >&2; exit 1",
            "sbatch: error: B",
        ),
        ("exit 3", "sbatch: exit code 3; by hand: "),
        (
            '[ "$3" = \'--array=0-2\' ] && exit 1; [ -e "$0.x" ] && exit 1; touch "$0.x"; echo 77',
            "sbatch: exit code 1; ",
        ),
    ],
)
def test_a_queue_that_is_not_there_or_refuses_is_one_line(queue_says, line, tmp_path, out):
    if queue_says is not None:
        program(tmp_path / "bin", "sbatch", f"#!/bin/bash\n{queue_says}\n")
    done = submit(tmp_path, out, "--slurm", "--cells-per-job", "3", "--array-limit", "3", "--go")
    assert (done.returncode, done.stderr.count("\n")) == (4, 1)
    assert done.stderr.startswith(line)
    assert ("handed in before that: 77" in done.stderr) == ("77" in (queue_says or ""))


def test_a_run_with_scripts_and_logs_is_removed_and_a_users_file_is_not(tmp_path, out):
    queue(tmp_path / "bin", "sbatch")
    told(submit(tmp_path, out, "--slurm", "--cells-per-job", "9", "--go", "--json"))
    run = the_run(out)
    assert len([*(run / "jobs").iterdir()]) == 3
    (run / "jobs" / "mine.sh").write_text("#!/bin/bash\n")
    done = visitlab("runs", "rm", run.name, "--yes", "--out", out)
    assert (done.returncode, "jobs/mine.sh" in done.stderr) == (4, True)
    (run / "jobs" / "mine.sh").rename(run / "jobs" / "slurm.sh")
    done = visitlab("submit", TINY, "--slurm", "--out", out)
    assert (done.returncode, "not written by visitlab" in done.stderr) == (2, True)
    (run / "jobs" / "slurm.sh").unlink()
    done = visitlab("runs", "rm", run.name, "--yes", "--out", out)
    assert done.returncode == 0, done.stderr
    assert not run.exists()


def test_jobs_that_really_run_do_all_and_the_same_again_does_what_is_missing(tiny_run, tmp_path, out):
    queue(tmp_path / "bin", "sbatch")
    words = ["submit", TINY, "--slurm", "--cells-per-job", "9", "--out", out, "--go", "--json"]
    path = f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}"
    cache = os.environ.get("VISITLAB_CACHE") or str(
        user_cache_path("visitlab")
    )  # else the jobs compile into one of theirs
    more = {"cwd": tmp_path, "env": {"PATH": path, "VISITLAB_CACHE": cache}}
    first = told(visitlab(*words, **more))
    run = the_run(out)
    assert only_cells(hashes(run)) == only_cells(hashes(tiny_run))
    assert len(first["submitted"]) == 1
    shutil.rmtree(run / "visit")
    again = told(visitlab(*words, **more))
    assert (again["missing"], len(again["jobs"])) == (2, 1)
    assert only_cells(hashes(run)) == only_cells(hashes(tiny_run))
    done = visitlab(*words[:-1], **more)
    assert done.stdout == f"{run}: all {CELLS} cells are done\n"
