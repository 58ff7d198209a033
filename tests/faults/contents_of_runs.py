"""A run folder as others left it: damage, an edited config, links, pipes, a user's own files."""

import json
import os
from collections.abc import Callable
from pathlib import Path

from tests.faults.fault import Try, contents, fault
from tests.program import the_run

MEMORY = 1 << 30
"""Bytes that a command may hold, whatever lies in a run."""
LINE = 20.0
"""Seconds that a command may take to look at a small run."""
FILES = ("steps.mcap", "model.npz", "trials.parquet", "cell.json", "timing.json")


def commands(run: Path) -> list[tuple[object, ...]]:
    """Everything that reads a run."""
    return [
        ("runs", "show", run),
        ("runs", "verify", run, "--dry-run"),
        ("runs", "list", "--out", run.parent),
        ("runs", "diff", run, run),
        ("steps", run, "--trial", "3", "--experiment", "social"),
        ("affordances", run),
        ("affordances", run, "--models"),
        ("metrics", run),
        ("compare", run),
        ("export", run, "--csv"),
        ("report", run),
        ("figures", run),
        ("eval", run, "--trials", "2", "--frozen"),
        ("runs", "prune", run),
    ]


def looked_at(this: Try, run: Path, *codes: int) -> None:
    """A few of these commands, at random, each ends in clear lines, soon, in bounded memory."""
    for command in this.random.sample(commands(run), 4):
        done = this.visitlab(*command, limit=60)
        this.told(done, *(codes or (0, 2, 3, 4, 5)))
        this.wrong += [f"{done.words}: held {done.memory >> 20} MB"] * (done.memory > MEMORY)
        this.wrong += [f"{done.words}: took {done.seconds:.0f} s"] * (done.seconds > LINE)


DAMAGE: dict[str, Callable[[Try, Path], None]] = {
    "flipped": lambda this, file: this.edit(file, lambda data: _flip(this, data)),
    "cut": lambda this, file: os.truncate(file, this.random.randrange(file.stat().st_size)),
    "longer": lambda this, file: this.edit(file, lambda data: data + this.random.randbytes(3)),
    "emptied": lambda this, file: file.write_bytes(b"") and None,
    "zeros": lambda this, file: this.edit(file, lambda data: bytes(len(data))),
    "deleted": lambda this, file: file.unlink(),
}


def _flip(this: Try, data: bytes) -> bytes:
    changed = bytearray(data)
    changed[this.random.randrange(len(changed))] ^= 1 << this.random.randrange(8)
    return bytes(changed)


@fault(
    "damaged", "a file that cell.json hashes, or cell.json, is flipped, cut, emptied, deleted: verify names it", 24, 1
)
def damaged(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    name = FILES[:4][this.index % 4]
    cell = this.random.choice(sorted(path.parent for path in run.glob("**/cell.json")))
    DAMAGE[sorted(DAMAGE)[this.index // 4 % len(DAMAGE)]](this, cell / name)
    path = cell.relative_to(run).as_posix()
    kept = {file: time for file, time in this.finished(out).items() if not file.startswith(f"{cell}/")}
    this.told(this.visitlab("runs", "verify", run), 4, names="mend it with")
    verified = this.visitlab("runs", "verify", run, "--json", "--dry-run")
    faults = {fault["cell"] for fault in json.loads(verified.stdout)["faults"]}
    this.wrong += [f"verify blames {sorted(faults)}, not {path}"] * (faults != {path})
    this.resumed(out, kept)
    this.told(this.visitlab("runs", "verify", run), 0)


@fault(
    "damaged-config", "the run's own config or versions.json is cut, flipped, emptied, deleted: told and mended", 8, 0
)
def damaged_config(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    file = run / ["config.yaml", "versions.json"][this.index % 2]
    whole = file.read_bytes()
    DAMAGE[sorted(DAMAGE)[this.index // 2 % len(DAMAGE)]](this, file)
    if this.index % 2 == 0 and file.exists() and file.read_bytes() != whole:
        looked_at(this, run)
    verified = this.visitlab("runs", "verify", run)
    this.told(verified, 0, 4)
    done = this.run(out)
    if this.told(done, 0, 4, names="edited|damaged"):
        if done.code:
            file.unlink(missing_ok=True)
        this.resumed(out)


@fault("edited-config", "a run's own config is edited: refused, and the difference is told", 5, 1)
def edited_config(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    edits = [
        ("alpha: 0.5", "alpha: 0.25"),
        ("p_A: 0.05", "p_A: 0.15"),
        ("gamma: 0.9", "gamma: 0.8"),
        ("seed: 7", "seed: 8"),
        ("steps: 200000", "steps: 400000"),
    ]
    old, new = edits[this.index % len(edits)]
    text = (run / "config.yaml").read_text()
    if old not in text:
        this.wrong.append(f"the run's config has no {old!r}")
        return
    (run / "config.yaml").write_text(text.replace(old, new, 1))
    kept = this.finished(out)
    this.told(this.run(out), 4, names=rf"edited.*{old.split(':')[0]}")
    this.told(this.visitlab("runs", "verify", run), 4)
    (run / "config.yaml").write_text(text)
    this.resumed(out, kept)


PLACES = (
    "social/mb/fast/seed-0000",
    "social/mb/fast",
    "social",
    "figures",
    "evaluations",
    "report.html",
    "config.yaml",
    "versions.json",
    "visit/fast/seed-0001/model.npz",
    "visit/fast/seed-0001/cell.json",
    "visit/fast/seed-0001/steps.mcap",
    "social/mb/fast/seed-0000/timing.json",
)


@fault(
    "links",
    "a link that leads out of the run, in place of a cell, a folder or a file: nothing outside is touched",
    18,
    1,
)
def links(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    outside = this.folder / "outside"
    outside.mkdir()
    (outside / "notes.txt").write_text("mine")
    (outside / "report.html").write_text("mine")
    place = run / PLACES[this.index % len(PLACES)]
    target = outside / "target"
    if place.exists():
        place.rename(target)
        if this.index >= len(PLACES) and target.is_dir():
            (target / "cell.json").unlink(missing_ok=True)
    elif place.suffix:
        target.write_text("mine")
    else:
        target.mkdir()
        (target / "fig7.svg").write_text("<svg>mine</svg>")
        (target / "notes.txt").write_text("mine")
    place.symlink_to(this.random.choice([target, Path(os.path.relpath(target, place.parent))]))
    before = contents(outside)
    where = place.relative_to(run).as_posix()
    steps: list[tuple[object, ...]] = [
        ("run", this.bench.config, "--out", out, "-q"),
        ("eval", run, "--trials", "2", "--frozen", "-q"),
        ("figures", run),
        ("report", run),
        ("runs", "verify", run),
        ("run", this.bench.config, "--out", out, "-q"),
        ("runs", "prune", run),
        ("runs", "rm", run, "--yes"),
    ]
    for command in steps:
        this.told(this.visitlab(*command), 0, 2, 4, 5)
        this.unchanged(before, outside, f"{where} is a link; {command[0]} {command[1] if command[0] == 'runs' else ''}")
        if this.lost:
            return


@fault("pipes", "a pipe or a device in place of a file of a run: no command waits for it", 12, 0)
def pipes(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    names = [
        *(f"social/mb/fast/seed-0000/{name}" for name in FILES),
        "config.yaml",
        "versions.json",
        "report.html",
        "figures",
    ]
    place = run / names[this.index % len(names)]
    if place.exists():
        place.unlink()
    if this.index < len(names):
        os.mkfifo(place)
    else:
        place.symlink_to("/dev/zero")
    looked_at(this, run)
    for command in (("runs", "verify", run), ("run", this.bench.config, "--out", out, "-q")):
        this.told(this.visitlab(*command, limit=60), 0, 3, 4, 5)


@fault("own-files", "a user's own files in every folder of a run: kept by run, report, figures, prune and rm", 8, 1)
def own_files(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    mine = this.folder / "copy"
    places = [
        "notes.txt",
        "report.html",
        "figures/mine.svg",
        "figures/talk/slides.pdf",
        "social/mb/fast/seed-0000/remarks.md",
        "evaluations/mine.csv",
        "social/thoughts.txt",
        ".tmp-mine",
        "seed-0000/data.csv",
    ]
    alone = [
        places,
        ["report.html"],
        ["figures/mine.svg"],
        ["evaluations/mine.csv"],
        ["social/mb/fast/seed-0000/remarks.md"],
    ]
    chosen = alone[this.index] if this.index < len(alone) else this.random.sample(places, 3)
    for name in chosen:
        (run / name).parent.mkdir(parents=True, exist_ok=True)
        (run / name).write_text(f"my own {name}")
        (mine / name).parent.mkdir(parents=True, exist_ok=True)
        (mine / name).write_text(f"my own {name}")
    if this.index % 2:
        (run / "social/mb/fast/seed-0000/cell.json").write_text("{")
    before = contents(mine)
    steps: list[tuple[object, ...]] = [
        ("report", run),
        ("figures", run),
        ("runs", "verify", run),
        ("run", this.bench.config, "--out", out, "-q"),
        ("eval", run, "--trials", "2", "-q"),
        ("runs", "prune", run),
        ("runs", "rm", run, "--yes"),
    ]
    for command in steps:
        this.told(this.visitlab(*command), 0, 2, 4)
        after = {name: (run / name).read_bytes() if (run / name).exists() else b"" for name in before}
        gone = [name for name in before if after[name] != before[name]]
        if gone:
            this.lost.append(f"{' '.join(map(str, command[:2]))}: {', '.join(gone)} is gone or changed")
            return
