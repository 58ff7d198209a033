"""What is printed: nothing that files say commands a terminal, and nobody who stopped listening stops a run."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import visitlab_cli
from tests.program import COMMAND, TINY, the_run, visitlab
from visitlab_cli.terminal import plain, plain_text

PACKAGE = Path(visitlab_cli.__file__).parent
HOSTILE = "a\x1b]0;owned\x07\x9b31m\u202eb\u200b\u2028[red]x[/]\r\nkept all\ud800\u3164"
NAVIGATION = "experiments={navigation: {task: navigation, agents: [mf], steps: 1200}}"


OBEYED = ["\x07", "\b", "\r", "\x7f", "\x9b", "\n", "\t", "\x1b[2J"]
UNSEEN = list("\u061c\u200b\u2028\u202e\u2066\ufeff\ud800\U000e0041\u3164\u115f\u2800")


@pytest.mark.parametrize("text", OBEYED + UNSEEN)
def test_what_a_terminal_obeys_and_nobody_sees_is_written_out(text):
    told = plain(f"a{text}b")
    assert told.isascii()
    assert told.isprintable()
    assert told == f"a{text.encode('unicode_escape').decode()}b"


@pytest.mark.parametrize(
    "text", ["", "naïve café", "日本語", "😀", "e\u0301", "a  b", "10\u202f000", "\u3000", "\\x1b"]
)
def test_what_people_write_stays(text):
    assert plain(text) == text


def test_a_text_keeps_its_lines():
    assert plain_text("a\n\x1b\n") == "a\n\\x1b\n"


def is_harmless(done, most_lines):
    for told in (done.stdout, done.stderr):
        assert told.replace("\n", "").isprintable(), told
        assert "\nkept all" not in told
        assert len(told.splitlines()) <= most_lines
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "arguments",
    [
        ["validate", HOSTILE],
        ["run", TINY, f"seeds={HOSTILE}"],
        ["runs", HOSTILE],
        ["export", "latest", "--csv", "--table", HOSTILE],
        ["runs", "list", "--out", HOSTILE],
    ],
    ids=lambda arguments: " ".join(map(str, arguments)).encode("unicode_escape").decode()[:30],
)
def test_a_hostile_argument_is_told_in_one_line(tmp_path, arguments):
    arguments = [str(each).replace("\ud800", os.fsdecode(b"\xff")) for each in arguments]
    is_harmless(visitlab(*arguments, cwd=tmp_path), 1)


def test_hostile_files_of_a_run_are_told_harmlessly(tiny_run, tmp_path):
    run = tmp_path / "runs" / HOSTILE.replace("\ud800", "").replace("/", "")
    shutil.copytree(tiny_run, run)
    cell = run / "navigation" / "mf" / "seed-0000" / "cell.json"
    facts = json.loads(cell.read_text())
    cell.write_text(json.dumps(facts | {"cell": HOSTILE, "versions": {HOSTILE: HOSTILE}, HOSTILE: HOSTILE}))
    (run / "versions.json").write_text(json.dumps({HOSTILE: HOSTILE}))
    config = run / "config.yaml"
    out = ["--out", run.parent]
    for arguments in (
        ["runs", "list", *out],
        ["runs", "verify", run],
        ["runs", "diff", run, tiny_run],
    ):
        is_harmless(visitlab(*arguments), 200)
    config.write_text(f"# {HOSTILE[:-2]}\n'{HOSTILE[1:8]}': 3\n" + config.read_text(), errors="replace")
    is_harmless(visitlab("runs", "show", run), 20)


def test_a_bug_of_ours_is_told_harmlessly_too():
    program = f"from visitlab_cli.terminal import open_streams; open_streams(); raise ValueError({HOSTILE!r})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "owned" in done.stderr
    assert done.stderr.replace("\n", "").isprintable()


def test_json_is_json_whatever_is_in_it(tmp_path):
    (tmp_path / "a\x7f\x1b").mkdir()
    done = visitlab("runs", "list", "--json", "--out", tmp_path / "a\x7f\x1b")
    assert json.loads(done.stdout)["folder"] == str(tmp_path / "a\x7f\x1b")
    assert done.stdout.replace("\n", "").isprintable()


def test_everything_is_printed_by_one_file():
    for file in PACKAGE.rglob("*.py"):
        text = file.read_text().replace("console.print(plain(", "")
        others = re.findall(r"typer\.echo|\bprint\(|std(?:out|err)\.write", text)
        assert not others or file.name == "terminal.py", file


def run_with(tmp_path, redirection, *more):
    """A run by a shell that redirects the program's streams."""
    command = [*COMMAND, "run", str(TINY), NAVIGATION, "--out", str(tmp_path / "runs"), *more]
    shell = 'exec "$@" ' + redirection
    return subprocess.run(
        ["bash", "-c", shell, "-", *command], check=False, capture_output=True, text=True, cwd=tmp_path
    )


@pytest.mark.parametrize("redirection", ["2>/dev/full", "<&- >&- 2>&-"])
def test_nobody_who_listens_is_no_reason_to_stop(tmp_path, redirection):
    done = run_with(tmp_path, redirection)
    assert done.returncode == 0, done.stderr
    assert (the_run(tmp_path / "runs") / "navigation" / "mf" / "seed-0000" / "cell.json").exists()
    for file in (tmp_path / "runs").rglob("*"):  # a closed stream's number is not that of a file of ours
        assert not file.is_file() or b"cells to do" not in file.read_bytes(), file


def test_a_result_that_cannot_be_written_is_told_when_all_is_done(tmp_path):
    done = run_with(tmp_path, ">/dev/full")
    assert done.returncode == 4
    assert done.stderr.endswith("\nthe output can't be written: No space left on device\n")
    assert (the_run(tmp_path / "runs") / "navigation" / "mf" / "seed-0000" / "cell.json").exists()


def test_too_many_open_files_names_the_limit(tmp_path):
    command = [*COMMAND, "run", str(TINY), "--out", str(tmp_path / "few"), "--workers", "2"]
    done = subprocess.run(
        ["bash", "-c", 'ulimit -n 9; exec "$@"', "-", *command], check=False, capture_output=True, text=True
    )
    assert done.returncode == 4
    assert "at most 9 at once); `ulimit -n`" in done.stderr
    assert "Traceback" not in done.stderr
