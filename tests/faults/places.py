"""Where and how the program is started: folders, names, variables, streams, modules that lie in the current folder."""

import os
import shutil
import subprocess
from pathlib import Path

from tests.faults.fault import Try, contents, fault
from tests.program import copy_package, the_run

NAMES = ("with space", "Ünïcode 日本", "a'b\"c", "-dash", "percent%20", "$HOME", "new\nline", "x" * 200)


@fault("folders", "runs folders with spaces, Unicode, quotes, a dash, 200 characters, a link", 9, 0)
def folders(this: Try) -> None:
    if this.index < len(NAMES):
        out = this.folder / NAMES[this.index]
    else:
        (this.folder / "there").mkdir()
        out = this.folder / "link"
        out.symlink_to("there")
    if this.told(this.visitlab("run", this.bench.config, f"--out={out}", "-q"), 0):
        this.whole(out)
    this.told(this.visitlab("runs", "list", f"--out={out}"), 0)
    this.told(this.visitlab("runs", "verify", the_run(out)), 0)


@fault("surroundings", "no HOME, no locale, no temporary folder or one with a long name, a folder that is gone", 10, 1)
def surroundings(this: Try) -> None:
    out = this.folder / "runs"
    long = this.folder / ("t" * 128)
    long.mkdir()
    unset = dict.fromkeys(("HOME", "XDG_CACHE_HOME", "USER", "LOGNAME", "PATH", "TERM", "LANG"))
    env: dict[str, str | None] = [
        {"HOME": None, "XDG_CACHE_HOME": None},
        unset | {"VISITLAB_CACHE": str(this.folder / "cache")},
        {"LC_ALL": "C", "PYTHONIOENCODING": "ascii"},
        {"TMPDIR": str(long)},
        {"TMPDIR": str(this.folder / "missing")},
        {"TMPDIR": "/dev/null"},
        {"TZ": "Mars/Olympus", "PYTHONHASHSEED": "1", "PYTHONOPTIMIZE": "1"},
        {"OMP_NUM_THREADS": "nonsense", "NUMBA_NUM_THREADS": "1", "PYTHONWARNINGS": "error"},
        {"COLUMNS": "0", "TERM": "dumb", "FORCE_COLOR": "1", "NO_COLOR": None},
        {"HOME": "/dev/null", "XDG_CACHE_HOME": "/dev/null"},
    ][this.index % 10]
    done = this.run(out, "--workers", 2, env=env)
    if this.told(done, 0):
        this.whole(out)


@fault("streams", "closed or full pipes and streams: nobody listens, the run goes on or ends in a line", 8, 1)
def streams(this: Try) -> None:
    out = this.folder / "runs"
    what = ["out closed", "err closed", "both closed", "head", "err full", "out full", "err pipe closed", "in closed"][
        this.index % 8
    ]
    command = [*this.bench.command, "run", str(this.bench.config), "--out", str(out), "--workers", "2"]
    shell = {
        "out closed": ">&-",
        "err closed": "2>&-",
        "both closed": ">&- 2>&-",
        "head": "| head -c 1 >/dev/null",
        "err full": "2>/dev/full",
        "out full": ">/dev/full",
        "err pipe closed": "2> >(exit 0)",
        "in closed": "<&-",
    }[what]
    words = " ".join(f"'{each}'" for each in command)
    done = subprocess.run(
        ["bash", "-c", f"set -o pipefail; {words} {shell}"],
        cwd=this.folder,
        capture_output=True,
        text=True,
        check=False,
        timeout=180,
    )
    allowed = {"out closed": (0, 4), "both closed": (0, 4), "out full": (4,)}.get(what, (0,))
    if done.returncode not in allowed:
        this.wrong.append(f"{what}: exit {done.returncode}: {done.stderr[-200:]!r}")
    if "Traceback" in done.stderr or "Exception ignored" in done.stderr:
        this.wrong.append(f"{what}: {done.stderr[:300]!r}")
    this.resumed(out)


MODULES = (
    "random",
    "socket",
    "json",
    "numpy",
    "multiprocessing",
    "typing",
    "platform",
    "tempfile",
    "yaml",
    "colorama",
    "sitecustomize",
)


@fault("modules", "modules of a user's in the current folder, called as the library's: they are never imported", 8, 1)
def modules(this: Try) -> None:
    out, here = this.folder / "runs", this.folder / "here"
    here.mkdir()
    marker = this.folder / "imported"
    names = list(MODULES) if this.index == 0 else this.random.sample(MODULES, 3)
    for name in names:
        (here / f"{name}.py").write_text(f"open({str(marker)!r}, 'a').write({name!r} + ' ')\nraise SystemExit(77)\n")
    for workers in (1, 2):
        done = this.run(out / str(workers), "--workers", workers, cwd=here)
        this.told(done, 0)
        if done.code == 0:
            this.whole(out / str(workers))
    if marker.exists():
        this.wrong.append(f"imported from the current folder: {marker.read_text()}")


def a_clone(this: Try, place: Path) -> Path:
    """A copy of the package in `place`, with a rule of the human edited."""

    package = place / "visitlab_cli"
    copy_package(package, "__pycache__")
    rule = package / "humans" / "six_parameters.py"
    text = rule.read_text()
    edited = text.replace("happens(random, human.p_M)", "False")
    assert edited != text
    rule.write_text(edited)
    return package


@fault(
    "clone", "started in a clone of the project with an edited rule: the installed program runs, not the clone's", 3, 0
)
def clone(this: Try) -> None:
    out, here = this.folder / "runs", this.folder / "here"
    a_clone(this, here)
    if this.told(this.run(out, "--workers", [2, 1, 3][this.index % 3], cwd=here), 0):
        this.whole(out)


@fault("other-sources", "a run is continued by a program with an edited rule: it is told, and verify tells it after", 2)
def other_sources(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    shutil.rmtree(run / "visit")
    shutil.rmtree(run / "social")
    package = a_clone(this, this.folder / "clone")
    env = {"PYTHONPATH": str(package.parent), "VISITLAB_CACHE": str(this.folder / "cache")}
    done = this.visitlab("run", this.bench.config, "--out", out, "--workers", 1 + this.index % 2, env=env)
    this.told(done, 0, 4)
    if "source" not in done.stderr:
        this.wrong.append("continuing with other sources is not told")
    verified = this.visitlab("runs", "verify", run)
    if "source" not in verified.stdout + verified.stderr:
        this.wrong.append("runs verify does not tell that sources are mixed")


FIGURES: list[dict[str, str | None]] = [
    {"RERUN": "off"},
    {"MPLBACKEND": "module://matplotlib_inline.backend_inline"},
    {"MPLBACKEND": "nonsense"},
    {"MATPLOTLIBRC": "usetex"},
    {"MATPLOTLIBRC": "fat"},
    {"PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "cpp"},
    {"PROTOCOL_BUFFERS_PYTHON_IMPLEMENTATION": "python"},
    {"MPLCONFIGDIR": "/dev/null"},
    {"SOURCE_DATE_EPOCH": "0"},
    {"LC_ALL": "de_DE.UTF-8", "LANG": "de_DE.UTF-8"},
]
RC = {
    "usetex": "text.usetex: True\n",
    "fat": "lines.linewidth: 12\nfont.size: 31\naxes.facecolor: black\nsvg.fonttype: none\n",
}


def drawn(this: Try, env: dict[str, str | None]) -> tuple[dict[str, bytes], list[str]]:
    """The pictures that the commands draw with these variables, and what failed."""
    run = the_run(this.copy_of_whole())
    made, failed = this.folder / "made", []
    made.mkdir()
    commands: list[tuple[object, ...]] = [
        ("figures", run),
        ("report", run),
        ("replay", run, "--trial", "3", "--strip", made / "strip.svg"),
        ("replay", run, "--trial", "3", "--save", made / "trial.rrd"),
    ]
    for command in commands:
        done = this.visitlab(*command, env=env)
        if done.code:
            failed.append(done.stderr.strip())
            names = "|".join(env)
            this.told(done, 2, 4, names=names)
        else:
            this.told(done, 0)
    files = contents(run / "figures") | contents(made) if (run / "figures").exists() else contents(made)
    shutil.rmtree(run.parent)
    shutil.rmtree(made)
    return {name: data for name, data in files.items() if not name.endswith(".rrd")}, failed


@fault(
    "variables",
    "RERUN, MPLBACKEND, a matplotlibrc, protobuf's variable: the same pictures, or a line that names it",
    10,
    0,
)
def variables(this: Try) -> None:
    env = dict(FIGURES[this.index % len(FIGURES)])
    if env.get("MATPLOTLIBRC") in RC:
        file = this.folder / "matplotlibrc"
        file.write_text(RC[str(env["MATPLOTLIBRC"])])
        env["MATPLOTLIBRC"] = str(file)
    expected, failed = drawn(this, {})
    this.wrong += [f"undisturbed: {line}" for line in failed]
    found, failed = drawn(this, env)
    this.wrong += [f"{name}: another picture" for name in found if found[name] != expected.get(name)]
    if not failed:
        this.wrong += [f"{name}: not drawn" for name in expected.keys() - found.keys()]


BAD_NAMES = ("../x", "/abs", "a/b", "..", "a\x00b", "a\nb", "n" * 300, "-dash", "latest")


@fault("names", "names such as ../x, a/b, .., NUL, a newline, 300 characters, a dash, a reserved word", 9, 1)
def names(this: Try) -> None:
    before = contents(this.folder)
    config = this.folder / "named.yaml"
    quoted = BAD_NAMES[this.index % len(BAD_NAMES)].replace("\x00", "\\0").replace("\n", "\\n")
    config.write_text(this.bench.config.read_text().replace("name: faults", f'name: "{quoted}"'))
    this.told(this.visitlab("run", config, "--out", this.folder / "runs", "-q"), 3, names="name")
    config.unlink()
    this.unchanged(before, this.folder, "refused")


@fault("terminal-closed", "the terminal is closed (SIGHUP, and its streams with it)", 4, 0, ["linux"])
def terminal_closed(this: Try) -> None:
    import pty
    import time

    out = this.folder / "runs"
    main, terminal = pty.openpty()
    program = this.bench.start(
        "run", this.bench.config, "--out", out, cwd=this.folder, stdin=terminal, stdout=terminal, stderr=terminal
    )
    os.close(terminal)
    time.sleep(this.random.uniform(0.2, 0.9) * this.bench.seconds)
    os.close(main)
    program.send_signal(1)
    done = this.bench.wait(program, limit=60)
    this.wrong += [f"exit {done.code} after the terminal was closed"] * (done.code not in (0, 130))
    this.resumed(out)
