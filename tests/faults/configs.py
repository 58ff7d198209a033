"""Configs that attack the reader, or ask for more than there is: refused at once, in little memory."""

import os
import signal
import subprocess
from collections.abc import Callable
from pathlib import Path

from tests.faults.fault import Try, fault
from visitlab_cli.yaml.files import PATIENCE

MEMORY = 500 << 20
SOON = 10.0
BASE = """name: base
agents: {mf: {kind: q_learning}}
experiments: {navigation: {task: navigation, agents: [mf], steps: 100}}
"""

TEXTS: dict[str, Callable[[], bytes]] = {
    "empty": lambda: b"",
    "a list": lambda: b"[1, 2]",
    "two documents": lambda: b"name: a\n---\nname: b\n",
    "a tab": lambda: b"name:\n\t- 1\n",
    "an alias bomb": lambda: (
        b"a0: &a0 [x]\n" + b"".join(b"a%d: &a%d [%s]\n" % (n, n, b"*a%d, " % (n - 1) * 9) for n in range(1, 20))
    ),
    "deep lists": lambda: b"[" * 5000,
    "deep maps": lambda: b"a: " + b"{a: " * 5000,
    "100 MB": lambda: b"- x\n" * (25 << 20),
    "doubled keys": lambda: BASE.encode() + b"name: other\n",
    "a key that is no text": lambda: BASE.encode() + b"5: 1\n",
    "a tag": lambda: b"a: !!python/object/apply:os.system [touch hacked]\n",
    "nan": lambda: BASE.encode() + b"seed: .nan\n",
    "1e400": lambda: BASE.encode() + b"seed: 1e400\n",
    "10**30": lambda: BASE.encode() + b"seeds: 1" + b"0" * 30 + b"\n",
    "no": lambda: BASE.encode() + b"seeds: no\n",
    "1_0": lambda: BASE.encode() + b"seeds: 1_0\n",
    "a byte order mark of UTF-16": lambda: BASE.encode("utf-16"),
    "not UTF-8": lambda: BASE.encode() + b"\xff\xfe",
    "NUL": lambda: BASE.encode() + b"\0",
    "a no-break space": lambda: BASE.replace(": ", ":\u00a0").encode(),
    "a line separator": lambda: BASE.replace("\n", "\u2028").encode(),
    "a grid of 10**9": lambda: (
        BASE.encode()
        + b"vary: {agents.mf.alpha: [%s], agents.mf.gamma: [%s], agents.mf.epsilon: [%s]}\n"
        % ((b", ".join(b"0.%04d" % n for n in range(1, 1001)),) * 3)
    ),
    "a grid of 400,000": lambda: (
        BASE.encode()
        + b"seeds: 4000\nvary: {agents.mf.alpha: [%s]}\n" % b", ".join(b"0.%03d" % n for n in range(1, 101))
    ),
    "a million seeds": lambda: BASE.encode() + b"seeds: 1000000\n",
    "10,000 unknown keys": lambda: BASE.encode() + b"".join(b"key%d: 1\n" % n for n in range(10_000)),
    "10,000 agents": lambda: b"name: x\nagents:\n" + b"".join(b"  a%d: {kind: nonsense}\n" % n for n in range(10_000)),
    "like in a circle": lambda: b"name: x\nhumans: {a: {like: b}, b: {like: a}}\n",
    "like 10,000 deep": lambda: (
        b"name: x\nhumans:\n" + b"".join(b"  h%d: {like: h%d}\n" % (n, n + 1) for n in range(10_000))
    ),
    "an escape": lambda: b'name: "\\e[31mred"\n',
    "a key of 100,000": lambda: BASE.encode() + b"k" * 100_000 + b": 1\n",
}


@fault(
    "yaml",
    "YAML that attacks its reader: bombs, depth, size, kinds, encodings, grids; refused with a place",
    len(TEXTS),
    2,
)
def yaml(this: Try) -> None:
    name = list(TEXTS)[this.index % len(TEXTS)]
    config = this.folder / "config.yaml"
    config.write_bytes(TEXTS[name]())
    done = this.visitlab("validate", config, limit=60)
    big = name == "a grid of 400,000"
    this.told(done, *((0, 3) if big else (3,)), names="config.yaml")
    bounded(this, done.words, name, done.seconds, done.memory)
    this.wrong += [f"{name}: {len(done.stderr)} characters of complaint"] * (len(done.stderr) > 20_000)
    this.wrong += ["a tag was obeyed"] * (this.folder / "hacked").exists()


def bounded(this: Try, words: str, name: str, seconds: float, memory: int) -> None:
    this.wrong += [f"{words}: {name}: took {seconds:.0f} s"] * (seconds > SOON)
    this.wrong += [f"{words}: {name}: held {memory >> 20} MB"] * (memory > MEMORY)


def _itself(folder: Path) -> str:
    return "include: [config.yaml]\n"


def _chain(folder: Path) -> str:
    for n in range(1000):
        (folder / f"c{n}.yaml").write_text(f"include: [c{n + 1}.yaml]\n")
    (folder / "c1000.yaml").write_text("humans: {a: {p_S: [1, 0, 0]}}\n")
    return "include: [c0.yaml]\n"


def _doubled(folder: Path) -> str:
    for n in range(30):
        (folder / f"c{n}.yaml").write_text(f"include: [c{n + 1}.yaml, ./c{n + 1}.yaml]\n")
    (folder / "c30.yaml").write_text("humans: {a: {p_S: [1, 0, 0]}}\n")
    return "include: [c0.yaml]\n"


def _pipe(folder: Path) -> str:
    os.mkfifo(folder / "pipe.yaml")
    return "include: [pipe.yaml]\n"


def _wide(folder: Path) -> str:
    (folder / "c.yaml").write_text("humans: {a: {p_S: [1, 0, 0]}}\n")
    return "include: [" + ", ".join(["c.yaml"] * 50_000) + "]\n"


def _links(folder: Path) -> str:
    (folder / "loop.yaml").symlink_to("loop.yaml")
    return "include: [loop.yaml]\n"


INCLUDES: dict[str, Callable[[Path], str]] = {
    "itself": _itself,
    "a thousand deep": _chain,
    "doubled thirty times": _doubled,
    "a pipe": _pipe,
    "50,000 times one file": _wide,
    "a device": lambda folder: "include: [/dev/zero]\n",
    "a folder": lambda folder: "include: [.]\n",
    "a link to itself": _links,
    "a missing file": lambda folder: "include: [missing.yaml]\n",
    "a name with NUL": lambda folder: 'include: ["a\\0b"]\n',
    "a name too long": lambda folder: f"include: [{'x' * 5000}]\n",
}


@fault(
    "include",
    "include of itself, a thousand deep, doubled thirty times, of a pipe, a device, a folder",
    len(INCLUDES),
    1,
)
def include(this: Try) -> None:
    name = list(INCLUDES)[this.index % len(INCLUDES)]
    config = this.folder / "config.yaml"
    config.write_text(INCLUDES[name](this.folder) + BASE)
    done = this.visitlab("validate", config, limit=60)
    this.told(done, *((0, 3) if name in ("50,000 times one file", "doubled thirty times") else (3, 5)))
    bounded(this, done.words, name, done.seconds, done.memory)


@fault("config-file", "the config itself is a pipe, a device, a folder, missing, unreadable", 5, 0)
def config_file(this: Try) -> None:
    file = this.folder / "config.yaml"
    kind = this.index % 5
    if kind == 0:
        os.mkfifo(file)
    elif kind == 1:
        file.symlink_to("/dev/zero")
    elif kind == 2:
        file.mkdir()
    elif kind == 3:
        file.symlink_to("config.yaml")
    done = this.visitlab("run", file, "--out", this.folder / "runs", "-q", limit=60)
    this.told(done, 3, 4, 5, names="config.yaml")
    bounded(this, done.words, str(kind), done.seconds - PATIENCE * (kind == 0), done.memory)


@fault(
    "big-grid", "a grid of 400,000 cells: the dry run tells its size soon, in bounded memory, and can be interrupted", 2
)
def big_grid(this: Try) -> None:
    config = this.folder / "config.yaml"
    config.write_bytes(TEXTS["a grid of 400,000"]())
    if this.index == 0:
        done = this.visitlab("run", config, "--dry-run", "--out", this.folder / "runs", limit=60)
        this.told(done, 0, 3)
        this.wrong += [f"took {done.seconds:.0f} s"] * (done.seconds > 30)
        this.wrong += [f"held {done.memory >> 20} MB"] * (done.memory > 2 * MEMORY)
        return
    program = this.bench.start("run", config, "--out", this.folder / "runs", "-q", cwd=this.folder)
    try:
        program.wait(5)
    except subprocess.TimeoutExpired:
        program.send_signal(signal.SIGINT)
    this.told(this.bench.wait(program, limit=30), 3, 130)


OVERRIDES = (
    "seeds",
    "=",
    "seeds=",
    "seeds=[",
    "a.b.c=1",
    "seeds=1=2",
    "humans.fast.p_A=2",
    "agents={}",
    "name=../x",
    "seeds=" + "9" * 5000,
    "agents.mf.alpha={a: " * 100,
    "include=[x]",
    "\x1b[31m=1",
    "seeds=1\nname=x",
)


@fault("overrides", "key=value arguments that are none, unknown, too large, deep, or hold escapes", len(OVERRIDES), 0)
def overrides(this: Try) -> None:
    done = this.visitlab(
        "run", this.bench.config, OVERRIDES[this.index % len(OVERRIDES)], "--out", this.folder / "runs", "--dry-run"
    )
    this.told(done, 2, 3, 5)
    bounded(this, done.words[:80], "override", done.seconds, done.memory)
