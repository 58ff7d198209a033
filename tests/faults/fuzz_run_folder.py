"""Random and crafted damage to the files of a run's folder, hashes made right: one line, or values that can be."""

import json
import multiprocessing
import multiprocessing.connection
import random
import resource
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from tests.faults.readers import CELLS, changed, judged, tiny_run
from tests.storage import hostile

ROOM = 1 << 30
"""Bytes of address space that a reader has beside what the program takes to start."""


def fuzz(n: int, seed: int, room: int = ROOM) -> list[str]:
    """Reads `n` damaged files in a process with little memory; a line for each wrong answer."""
    whole = tiny_run()
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_child, args=(n, seed, room, whole, sender))
    child.start()
    sender.close()
    try:
        wrong: list[str] = receiver.recv()
    except EOFError:
        wrong = []
    child.join()
    return wrong if child.exitcode == 0 else [*wrong, f"seed {seed}: the process ended with {child.exitcode}"]


def _child(n: int, seed: int, room: int, whole: Path, sender: "multiprocessing.connection.Connection") -> None:
    import numba  # noqa: F401
    import pyarrow  # noqa: F401

    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + room, used + room))
    with tempfile.TemporaryDirectory(prefix="visitlab-fuzz-") as folder:
        run = Path(shutil.copytree(whole, Path(folder) / whole.name))
        sender.send(fuzz_here(n, seed, run))


def fuzz_here(n: int, seed: int, run: Path) -> list[str]:
    """As `fuzz`, in this process, with a run that may be changed."""
    from visitlab_cli.config.loading import load
    from visitlab_cli.plan.cells import plan

    cells = {cell.path: cell for cell in plan(load(run / "config.yaml"))}
    wrong = []
    for number in range(n):
        chosen = random.Random(f"{seed}/{number}")
        path = chosen.choice(CELLS)
        name = chosen.choice(sorted(CHANGES))
        file = run / name if name in OF_RUN else run / path / name
        whole, facts = file.read_bytes(), (run / path / "cell.json").read_bytes()
        file.write_bytes(_damaged(chosen, name, whole))
        if name in ("model.npz", "trials.parquet") and chosen.random() < 0.9:
            hostile.restate(run / path)
        what = f"{path}/{name}, input {number} of seed {seed}"
        wrong += _check(what, run, cells[path], name)
        file.write_bytes(whole)
        (run / path / "cell.json").write_bytes(facts)
    return wrong


def _check(what: str, run: Path, cell: Any, name: str) -> list[str]:
    from visitlab_cli.plan.saved import model_of, trials_of
    from visitlab_cli.storage.cell_folder import read_cell
    from visitlab_cli.storage.facts import seconds_of
    from visitlab_cli.storage.run_folder import read_config, read_versions
    from visitlab_cli.storage.verify_cell import cell_faults

    readers: dict[str, Callable[[], Any]] = {
        "model.npz": lambda: model_of(run, cell),
        "trials.parquet": lambda: trials_of(run, cell),
        "cell.json": lambda: read_cell(run / cell.path),
        "timing.json": lambda: seconds_of(run / cell.path),
        "versions.json": lambda: read_versions(run),
        "config.yaml": lambda: read_config(run),
    }
    wrong, answer = judged(what, readers[name])
    if name == "model.npz" and answer is not None:
        wrong += [f"{what}: {fault}" for fault in _unsafe(answer)]
    if name == "trials.parquet" and answer is not None and not np.isfinite(answer["reward"]).all():
        wrong.append(f"{what}: rewards that are no numbers")
    found, faults = judged(what, lambda: cell_faults(run / cell.path, cell.path, cell.run_hash, cell.steps))
    return wrong + found + [f"{what}: verify says {text!r}" for _, text in faults or () if not text.isprintable()]


def _unsafe(model: dict[str, Any]) -> list[str]:
    """What of an accepted model a kernel would fall over, told by other means than those of the program."""
    wrong = [f"{name} is not finite" for name, array in model.items() if not np.isfinite(array).all()]
    if "successor_offsets" in model:
        states, counts = model["successor_states"], model["successor_counts"]
        for pair, (begin, end) in enumerate(
            zip(model["successor_offsets"], model["successor_offsets"][1:], strict=False)
        ):
            if not 0 <= begin <= end <= len(states) == len(counts):
                return [*wrong, f"pair {pair} has successors {begin} to {end} of {len(states)}"]
            if counts[begin:end].sum() != model["visits"].flat[pair]:
                return [*wrong, f"pair {pair}: counts are not visits"]
        if len(states) and (states.min() < 0 or states.max() >= len(model["q"])):
            wrong.append("a successor outside of the table")
    return wrong


def _damaged(chosen: random.Random, name: str, whole: bytes) -> bytes:
    """A file with changes that know what it is, or that do not."""
    try:
        return chosen.choice([changed_bytes, changed_bytes, *CHANGES[name]])(chosen, whole)
    except (KeyError, ValueError, TypeError, AttributeError, IndexError):  # of another kind of agent or task
        return changed(whole, chosen)


def changed_bytes(chosen: random.Random, whole: bytes) -> bytes:
    """One to four random changes."""
    return changed(whole, chosen)


def crafted(
    changes: dict[str, Callable[[bytes], bytes]], heavy: tuple[str, ...]
) -> Callable[[random.Random, bytes], bytes]:
    """One of the crafted changes, the slow ones aside."""
    names = [name for name in changes if name not in heavy]
    return lambda chosen, whole: changes[chosen.choice(names)](whole)


def odd_array(chosen: random.Random, whole: bytes) -> bytes:
    """A model with a value, or the length, of one array changed."""
    names = ["q", "visits", "reward_sums", "successor_offsets", "successor_states", "successor_counts", "random_state"]
    values = [-1, 0, 1, 2**31 - 1, -(2**31), 320, 5000, 2**40]
    change = chosen.choice(
        [
            lambda array: hostile.put(chosen.randrange(array.size), chosen.choice(values))(array),
            lambda array: array[: chosen.randrange(len(array))],
            lambda array: np.concatenate([array, array]),
            lambda array: np.roll(array, chosen.randrange(1, 9)),
            lambda array: array.astype(chosen.choice(["<i2", "<i8", ">f8", "<f4", "<u4", "complex", "U3", "?"])),
        ]
    )
    return hostile.with_arrays(**{chosen.choice(names): change})(whole)


def odd_footer(chosen: random.Random, whole: bytes) -> bytes:
    """A table whose description alone is changed, and its length right."""
    return hostile.with_footer(lambda footer: changed(footer, chosen))(whole)


def odd_page(chosen: random.Random, whole: bytes) -> bytes:
    """A table with a few bytes of a page, or its header, changed."""
    content = bytearray(whole)
    for _ in range(chosen.randrange(1, 4)):
        content[chosen.randrange(4, len(content) // 2)] = chosen.choice(
            [0, 1, 0x15, 0x7F, 0x80, 0xFF, chosen.randrange(256)]
        )
    return bytes(content)


def odd_value(chosen: random.Random, whole: bytes) -> bytes:
    """A document with one value, at any depth, replaced."""
    document = json.loads(whole)
    place = document
    while True:
        key = chosen.choice(sorted(place))
        if not isinstance(place[key], dict) or not place[key] or chosen.random() < 0.3:
            break
        place = place[key]
    place[key] = "@"
    value = chosen.choice(sorted(hostile.VALUES.values()))
    return json.dumps(document, indent=2, sort_keys=True).replace('"@"', value).encode() + b"\n"


OF_RUN = ("versions.json", "config.yaml")
CHANGES: dict[str, list[Callable[[random.Random, bytes], bytes]]] = {
    "model.npz": [odd_array, odd_array, crafted(hostile.MODELS, ("bomb",))],
    "trials.parquet": [
        odd_footer,
        odd_footer,
        odd_page,
        crafted(hostile.TRIALS, ("forty million rows", "ten thousand columns")),
    ],
    "cell.json": [odd_value, odd_value],
    "timing.json": [odd_value],
    "versions.json": [odd_value],
    "config.yaml": [],
}
