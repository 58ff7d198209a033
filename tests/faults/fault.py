"""A class of faults, one try of it, and the list of all classes."""

import os
import random
import re
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import NamedTuple

from tests.faults.bench import Bench, Done
from tests.program import hashes, only_cells, the_run

ESCAPES = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")
RAW = re.compile(
    r"Traceback|^  File \"|\b[A-Z]\w*(?:Warning|Error|Exception)\b: |can't be written: (?:None)?$", re.MULTILINE
)
"""What a user never sees: a traceback, a warning, an exception by its name, a reason that is none."""


class Fault(NamedTuple):
    """A class: how often it is tried, in all and in the slice for CI, what it `needs` of the machine."""

    name: str
    about: str
    tries: int
    fast: int
    needs: tuple[str, ...]
    check: "Callable[[Try], None]"


FAULTS: dict[str, Fault] = {}


def fault(
    name: str, about: str, tries: int, fast: int = 0, needs: Iterable[str] = ()
) -> "Callable[[Callable[[Try], None]], Callable[[Try], None]]":
    """Decorator: this function does the fault once, and tells the `Try` what was lost and what was wrong."""

    def register(check: Callable[[Try], None]) -> Callable[[Try], None]:
        FAULTS[name] = Fault(name, about, tries, fast, tuple(needs), check)
        return check

    return register


class Try:
    """One try: its random numbers, a folder of its own, and what it found.

    `lost` is finished work or a user's file that is gone or changed; `wrong` all else that must not be: other bytes, a
    traceback, an untrue exit code, a hang, too much memory. `count` is how many inputs it stands for; 0 where the fault
    came too late to be one.
    """

    def __init__(self, name: str, index: int, seed: int, bench: Bench) -> None:
        self.name, self.index, self.bench = name, index, bench
        self.random = random.Random(f"{seed}/{name}/{index}")
        self.seed = seed
        self.folder = bench.new_folder(f"{name}-{index}")
        self.lost: list[str] = []
        self.wrong: list[str] = []
        self.count = 1
        self.seconds = 0.0

    def visitlab(self, *arguments: object, **options: object) -> Done:
        """Run the program to its end, from a folder of its own."""
        return self.bench.run(*arguments, cwd=options.pop("cwd", self.folder), **options)

    def run(self, out: Path, *arguments: object, **options: object) -> Done:
        """Run the bench's config quietly."""
        return self.visitlab("run", self.bench.config, "--out", out, "-q", *arguments, **options)

    def told(self, done: Done, *codes: int, names: str = "", exceptions: bool = False) -> bool:
        """Whether a command ended with one of the exit codes and, if that is a failure, with clear lines.

        Args:
            done: the command.
            codes: those that are right; 0 alone if none is given.
            names: a pattern that a failure's last line must have.
            exceptions: whether the name of an exception may be shown (the cause was one that a test put there).
        """
        before = len(self.wrong)
        last = done.stderr.strip().splitlines()[-1:] or [""]
        words = f"{done.words}: exit {done.code}: {last[0][:200]!r}"
        if done.timed_out:
            self.wrong.append(f"{done.words}: hangs")
            return False
        if done.code not in (codes or (0,)):
            self.wrong.append(f"not exit {' or '.join(map(str, codes or (0,)))}: {words}")
        text = done.stdout + done.stderr
        found = RAW.search(text)
        if found and not (exceptions and "Traceback" not in text):
            self.wrong.append(f"shows {text[found.start() :][:160]!r}: {words}")
        if ESCAPES.search(text):
            self.wrong.append(f"control characters reach the terminal: {words}")
        if done.code > 0 and not last[0]:
            self.wrong.append(f"fails without a word: {words}")
        if done.code > 0 and names and not re.search(names, done.stderr):
            self.wrong.append(f"does not say {names!r}: {words}")
        return len(self.wrong) == before

    def finished(self, out: Path) -> dict[str, int]:
        """The time of change of each file of a finished cell below `out`, by its path."""
        return {
            file.as_posix(): file.stat().st_mtime_ns
            for cell in out.glob("*/**/cell.json")
            if ".tmp-" not in cell.as_posix()
            for file in cell.parent.iterdir()
        }

    def resumed(self, out: Path, kept: dict[str, int] | None = None, **options: object) -> None:
        """Run again: it ends well, with the bytes of an undisturbed run; what was finished is untouched."""
        kept = self.finished(out) if kept is None else kept
        self.later(out)
        if not self.told(self.run(out, **options), 0):
            return
        self.whole(out, kept)

    def later(self, out: Path) -> None:
        """Let some time pass: of a file without a lock nobody can tell at once whether it is still being written."""
        for file in out.glob("*/.tmp-*"):
            if file.is_file() and file.suffix != ".lock":
                os.utime(file, (1, 1))

    def whole(self, out: Path, kept: dict[str, int] | None = None) -> None:
        """The run below `out` is as the undisturbed one, and what was finished is untouched."""
        run = the_run(out)
        found, expected = only_cells(hashes(run)), self.bench.expected
        self.wrong += [f"{path}: other bytes" for path in expected if path in found and found[path] != expected[path]]
        self.wrong += [f"{path}: missing after a run that ended well" for path in expected.keys() - found.keys()]
        self.wrong += [f"{path}: not of an undisturbed run" for path in found.keys() - expected.keys()]
        self.wrong += [f"left over: {path.name}" for path in run.glob(".tmp-*")]
        for path, time in (kept or {}).items():
            if not Path(path).exists() or Path(path).stat().st_mtime_ns != time:
                self.lost.append(f"{path}: was finished, and was made again")

    def unchanged(self, before: dict[str, bytes], folder: Path, what: str) -> None:
        """A user's files are as they were."""
        after = contents(folder)
        self.lost += [f"{what}: {path} is gone or changed" for path in before if after.get(path) != before[path]]
        self.wrong += [f"{what}: {path} appeared" for path in after.keys() - before.keys()]

    def copy_of_whole(self) -> Path:
        """The folder of runs that holds a copy of the undisturbed run."""
        out = self.folder / "runs"
        shutil.copytree(self.bench.whole, out / self.bench.whole.name)
        return out

    def edit(self, file: Path, change: Callable[[bytes], bytes]) -> None:
        """Write a file anew, its bytes changed."""
        file.write_bytes(change(file.read_bytes()))


def contents(folder: Path) -> dict[str, bytes]:
    """The bytes of every file below a folder by its path; of a link where it leads."""
    return {
        path.relative_to(folder).as_posix(): str(path.readlink()).encode() if path.is_symlink() else path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_symlink() or path.is_file()
    }
