"""Fuzzing of what reads files: each function makes `n` inputs from a `seed` and returns what was wrong.

Bytes of a whole file are flipped, cut, repeated, replaced by other parts of it or by numbers at a boundary; each reader
answers with a value or with one clear line. What is wrong: another exception, several lines, control characters, a
warning, seconds, and, where a reader must notice damage, another value than what was written.
"""

import os
import random
import re
import shutil
import tempfile
import time
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from tests.config.lab import LAB
from visitlab_cli.errors import VisitlabError

SLOW = 5.0
TINY_RUN = "FAULTS_TINY_RUN"
"""The variable in which who starts the fuzzing names the run whose files are fuzzed."""
BOUNDARIES = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 0xFFFFFFFFFFFFFFFF)
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


def changed(data: bytes, chosen: random.Random) -> bytes:
    """A whole file's bytes with one to four changes."""
    bytes_ = bytearray(data)
    for _ in range(chosen.choice([1, 1, 1, 2, 4])):
        place, kind = chosen.randrange(len(bytes_) + 1), chosen.randrange(8)
        length = chosen.choice([1, 2, 4, 8, chosen.randrange(1, 200)])
        if kind < 3:
            bytes_[place : place + 1] = (
                bytes([bytes_[place] ^ 1 << chosen.randrange(8)]) if place < len(bytes_) else b""
            )
        elif kind == 3:
            del bytes_[place:]
        elif kind == 4:
            del bytes_[place : place + length]
        elif kind == 5:
            bytes_[place:place] = bytes_[place : place + length]
        elif kind == 6:
            other = chosen.randrange(len(bytes_) + 1)
            bytes_[place : place + length] = bytes_[other : other + length]
        else:
            size = chosen.choice([1, 2, 4, 8])
            number = chosen.choice(BOUNDARIES) & (1 << 8 * size) - 1
            bytes_[place : place + size] = number.to_bytes(size, "little")
        if not bytes_:
            break
    return bytes(bytes_)


def judged(what: str, read: Callable[[], Any], lines: int = 1) -> tuple[list[str], Any]:
    """What was wrong with how a reader answered, and its answer; None where it refused."""
    begun = time.monotonic()
    answer = None
    wrong = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            answer = read()
        except VisitlabError as error:
            text = str(error)
            if not text.strip() or text.count("\n") >= lines or CONTROL.search(text):
                wrong.append(f"{what}: no clear line: {text[:200]!r}")
        except BaseException as error:  # whatever it is, a user would see it
            wrong.append(f"{what}: {type(error).__name__}: {str(error)[:200]}")
    if time.monotonic() - begun > SLOW:
        wrong.append(f"{what}: took {time.monotonic() - begun:.0f} s")
    return wrong, answer


@cache
def tiny_run() -> Path:
    """A small finished run, made once: by who started us, or here."""
    from tests.program import TINY, the_run, visitlab

    if made := os.environ.get(TINY_RUN):
        return Path(made)
    out = Path(tempfile.mkdtemp(prefix="visitlab-fuzz-"))
    done = visitlab("run", TINY, "--out", out, "--workers", 1, "-q")
    assert done.returncode == 0, done.stderr
    return the_run(out)


CELLS = (
    "social/mb/fast/seed-0000",
    "navigation/rmax/seed-0000",
    "visit/fast/seed-0000",
    "social/watcher/fast/seed-0000",
)


def _of_cell(n: int, seed: int, name: str, read: Callable[[Any, Path], Any], same: bool) -> list[str]:
    """Fuzz one file of a cell by what the Python door reads of it; `same`: what it gives must be what was written."""
    import visitlab_cli

    chosen = random.Random(f"{name}/{seed}")
    with tempfile.TemporaryDirectory(prefix="visitlab-fuzz-") as there:
        run = Path(shutil.copytree(tiny_run(), Path(there) / tiny_run().name))
        cells = {cell.path: cell for cell in visitlab_cli.load(run).cells}
        wholes = {path: (run / path / name).read_bytes() for path in CELLS}
        expected = {path: read(cells[path], run) for path in CELLS}
        wrong = []
        for number in range(n):
            path = chosen.choice(CELLS)
            content = changed(wholes[path], chosen)
            (run / path / name).write_bytes(content)
            found, answer = judged(
                f"{path}/{name}, input {number} of seed {seed}", lambda path=path: read(cells[path], run)
            )
            wrong += found
            if same and answer is not None and content != wholes[path] and not _equal(answer, expected[path]):
                wrong.append(f"{path}/{name}, input {number} of seed {seed}: other values, and nobody noticed")
            (run / path / name).write_bytes(wholes[path])
    return wrong


def _equal(first: dict[str, Any], second: dict[str, Any]) -> bool:
    return first.keys() == second.keys() and all(np.array_equal(first[name], second[name]) for name in first)


def fuzz_npz(n: int, seed: int) -> list[str]:
    """Models: an archive's CRCs tell every change of a value."""
    return _of_cell(n, seed, "model.npz", lambda cell, run: cell.model, same=True)


def fuzz_parquet(n: int, seed: int) -> list[str]:
    """Tables of trials: Parquet has no checksums, which is why `cell.json` holds a hash."""
    return _of_cell(n, seed, "trials.parquet", lambda cell, run: cell.trials, same=False)


def fuzz_json(n: int, seed: int) -> list[str]:
    """`cell.json`: what it says of a cell, and what `verify` says of it."""
    from visitlab_cli.storage.cell_folder import read_cell
    from visitlab_cli.storage.verify_cell import cell_faults

    def read(cell: Any, run: Path) -> dict[str, Any]:
        facts = read_cell(cell.folder)
        faults = cell_faults(cell.folder, cell.path, run.name.rpartition("-")[2], None)
        for _, problem in faults:
            if "\n" in problem or CONTROL.search(problem):
                raise ValueError(f"verify says {problem!r}")
        return {"facts": facts is not None, "faults": bool(faults)}

    return _of_cell(n, seed, "cell.json", read, same=False)


def fuzz_mcap(n: int, seed: int) -> list[str]:
    """Logs: what can be read or recovered is what was written, row by row."""
    from visitlab_cli.log.reader import read_steps, read_trial
    from visitlab_cli.log.recovery.recovery import recover

    chosen = random.Random(f"mcap/{seed}")
    wrong = []
    with tempfile.TemporaryDirectory(prefix="visitlab-fuzz-") as there:
        broken, fixed = Path(there) / "broken.mcap", Path(there) / "fixed.mcap"
        for number in range(n):
            original = tiny_run() / chosen.choice(CELLS) / "steps.mcap"
            content = changed(original.read_bytes(), chosen)
            broken.write_bytes(content)
            what = f"{original.parent.relative_to(tiny_run())}, input {number} of seed {seed}"
            found, steps = judged(f"{what}, steps", lambda: read_steps(broken))
            wrong += found
            if steps is not None and content != original.read_bytes() and not _equal(steps, read_steps(original)):
                wrong.append(f"{what}: other steps, and nobody noticed")
            wrong += judged(f"{what}, a trial", lambda: read_trial(broken, 2))[0]
            fixed.unlink(missing_ok=True)
            found, saved = judged(f"{what}, recover", lambda: recover(broken, fixed))
            wrong += found
            if saved is not None and not _part_of(read_steps(fixed), read_steps(original)):
                wrong.append(f"{what}: recovered steps that never were")
    return wrong


def _part_of(found: dict[str, Any], whole: dict[str, Any]) -> bool:
    names = sorted(found.keys() & whole.keys())
    rows = set(zip(*(whole[name].tolist() for name in names), strict=True))
    return all(row in rows for row in zip(*(found[name].tolist() for name in names), strict=True))


TOKENS = (
    "- ",
    ": ",
    "{",
    "}",
    "[",
    "]",
    "&a ",
    "*a",
    "!x ",
    "|\n",
    ">\n",
    "'",
    '"',
    "# ",
    "---\n",
    "\t",
    "~",
    ".nan",
    "1e400",
    "no",
    "0o7",
    "\ufeff",
    "<<: ",
    "? ",
    "\u2028",
    "\x85",
    "\xa0",
    "include: [lab.yaml]\n",
    "like: ",
    "vary: {agents.mb.epsilon: [0, 1]}\n",
    "9" * 50,
    "-1",
    "[" * 40,
)


def fuzz_yaml(n: int, seed: int) -> list[str]:
    """Configs: typos, tokens, repeated and moved lines; every complaint has a place."""
    from visitlab_cli.config.loading import load

    chosen = random.Random(f"yaml/{seed}")
    wrong = []
    with tempfile.TemporaryDirectory(prefix="visitlab-fuzz-") as there:
        config = Path(there) / "lab.yaml"
        for number in range(n):
            if number % 3 == 0:
                config.write_bytes(changed(LAB.encode(), chosen))
            else:
                config.write_text(_typed(chosen), encoding="utf-8", errors="surrogatepass")
            wrong += judged(f"lab.yaml, input {number} of seed {seed}", lambda: load(str(config)), lines=60)[0]
    return wrong


def _typed(chosen: random.Random) -> str:
    lines = LAB.splitlines(keepends=True)
    for _ in range(chosen.choice([1, 1, 2, 3])):
        line = chosen.randrange(len(lines))
        kind = chosen.randrange(5)
        place = chosen.randrange(len(lines[line]))
        if kind == 0:
            lines[line] = lines[line][:place] + chosen.choice(TOKENS) + lines[line][place:]
        elif kind == 1:
            lines[line] = re.sub(r"[\w.]+(?=[,}\]\n])", chosen.choice(TOKENS), lines[line], count=1)
        elif kind == 2:
            lines.insert(chosen.randrange(len(lines)), lines[line])
        elif kind == 3:
            lines[line] = chosen.choice(["  ", "\t", ""]) + lines[line].lstrip(chosen.choice([" ", ""]))
        else:
            lines[line] = lines[line][:place] + lines[line][place + 1 :]
    return "".join(lines)


FUZZERS: dict[str, Callable[[int, int], list[str]]] = {
    "yaml": fuzz_yaml,
    "npz": fuzz_npz,
    "parquet": fuzz_parquet,
    "json": fuzz_json,
    "mcap": fuzz_mcap,
}
