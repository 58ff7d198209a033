"""What a colleague's run may hold: any value of any kind, with right hashes, and text that attacks who looks at it."""

import json
import shutil
from pathlib import Path

import numpy as np

from tests.faults.contents_of_runs import commands, looked_at
from tests.faults.fault import Try, fault
from tests.program import the_run
from visitlab_cli.storage.cell_folder import describe, to_json

VALUES = {
    "<script>alert(1)</script>": "html",
    "\x1b[31mred\x1b]0;title\x07": "terminal",
    "=1+1": "formula",
    "\u202eabc": "terminal",
    "x" * 100_000: "long",
    "\nhidden": "terminal",
}


def hostile_json(this: Try, document: object) -> object:
    """A document with one value, anywhere in it, replaced by another of a wrong kind or size."""
    values = [None, -1, 10**400, 1e308, "", [], {}, True, *VALUES, float(2**63), [[[]]] * 100]
    places = [(document, key) for key in (document if isinstance(document, dict) else ())]
    places += [
        (inner, key)
        for value in dict(document).values()
        if isinstance(value, dict)
        for inner in [value]
        for key in inner
    ]  # type: ignore[call-overload]
    holder, key = this.random.choice(places)
    holder[key] = this.random.choice(values)  # type: ignore[index]
    return document


@fault(
    "hostile-json",
    "cell.json, timing.json, versions.json of a colleague: any value of any kind, deep, long, repeated",
    12,
    0,
)
def hostile_jsons(this: Try) -> None:
    run = the_run(this.copy_of_whole())
    name = ["cell.json", "timing.json", "versions.json"][this.index % 3]
    file = run / name if name == "versions.json" else run / "social/mb/fast/seed-0000" / name
    kind = this.random.randrange(4)
    if kind == 0:
        file.write_text(
            this.random.choice(["[" * 100_000, '{"a":' * 50_000, "1" * 1_000_000, "[]", "null", '"x"', "NaN"])
        )
    else:
        document = json.loads(file.read_text())
        for _ in range(kind):
            hostile_json(this, document)
        file.write_text(json.dumps(document))
    looked_at(this, run)


def signed(cell: Path) -> None:
    """Make `cell.json` state the right hashes of what lies beside it, as a colleague's would."""
    stated = json.loads((cell / "cell.json").read_text())
    stated["files"] = {name: describe(cell / name) for name in stated["files"]}
    (cell / "cell.json").write_text(to_json(stated))


def hostile_array(this: Try, values: np.ndarray) -> np.ndarray:
    """An array of another shape, kind or range."""
    flat = values.copy().reshape(-1)
    choice = this.random.randrange(9)
    if choice < 4 and flat.size:
        extremes = [-1, 2**31 - 1, -(2**31), 10**6] if flat.dtype.kind in "iu" else [np.nan, np.inf, -np.inf, 1e308]
        with np.errstate(all="ignore"):
            flat[:: max(1, flat.size // 7)] = np.array(extremes[choice]).astype(flat.dtype)
        return flat.reshape(values.shape)
    made = [values[:0], flat, values[: len(values) // 2], values.astype("U8"), np.array(7)]
    return made[this.random.randrange(len(made))]


MODULES = ("friends/phases", "social/mb/fast", "navigation/mf", "several/multi/fast", "go_to_human/mb")


@fault(
    "hostile-models",
    "model.npz or trials.parquet of a colleague, with right hashes: impossible values, shapes, kinds",
    20,
    1,
)
def hostile_models(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    cell = run / MODULES[this.index % len(MODULES)] / "seed-0000"
    if this.random.random() < 0.25:
        hostile_table(this, cell / "trials.parquet")
    else:
        with np.load(cell / "model.npz") as archive:
            arrays = dict(archive)
        for name in this.random.sample(sorted(arrays), this.random.randrange(1, 3)):
            arrays[name] = hostile_array(this, arrays[name])
        np.savez_compressed(cell / "model.npz", **arrays)
    signed(cell)
    looked_at(this, run)
    for visit in ("visit/fast", "friends/phases"):
        shutil.rmtree(run / visit / "seed-0000")
    this.told(this.run(out, limit=90), 0, 4)


def hostile_table(this: Try, file: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    table = parquet.read_table(file)
    rows = table.num_rows
    tables = [
        table.slice(0, 0),
        table.drop_columns(["reward"]),
        table.select(["reward"]),
        pyarrow.table({"trial": ["x"] * rows, "reward": ["=1+1"] * rows}),
        pyarrow.table({"trial": [None] * rows, "reward": [None] * rows}),
        pyarrow.table({"trial": [-(2**40)] * rows, "reward": [float("nan")] * rows}),
        pyarrow.table({"trial": [[1]] * rows, "reward": [{"a": 1}] * rows}),
        pyarrow.table(
            {"trial": pyarrow.array(np.zeros(30_000_000, np.int64)), "reward": pyarrow.array(np.zeros(30_000_000))}
        ),
    ]
    parquet.write_table(this.random.choice(tables), file, compression="zstd")


@fault(
    "markup",
    "escape sequences, <script> and formulas in names and files of a run reach no terminal, page or table",
    4,
    0,
)
def markup(this: Try) -> None:
    out = this.copy_of_whole()
    run = the_run(out)
    text = list(VALUES)[this.index % 4]
    run = run.rename(out / f"x{text.replace('/', '')}")
    for file in [
        run / "versions.json",
        run / "social/mb/fast/seed-0000/cell.json",
        run / "social/mb/fast/seed-0000/timing.json",
    ]:
        document = json.loads(file.read_text())
        (document.get("versions") or document)["visitlab"] = text
        document["host"] = text
        file.write_text(json.dumps(document))
    for command in commands(run):
        this.told(this.visitlab(*command), 0, 2, 3, 4, 5)
    for page in run.rglob("*.html"):
        this.wrong += [f"{page.name} holds {text!r}"] * (VALUES[text] == "html" and text in page.read_text())
    for table in this.folder.rglob("*.csv"):
        cells = [cell.strip('"') for line in table.read_text().splitlines() for cell in line.split(",")]
        this.wrong += [f"{table.name} has a formula"] * any(cell.startswith(("=", "@")) for cell in cells)
