"""`visitlab export --csv` and `--parquet`: every row of every cell, told apart; nothing that is a formula."""

import csv
import json

import numpy as np
import pyarrow
import pytest
from pyarrow import parquet

from tests.program import visitlab
from tests.results.runs_by_hand import open_lab, write_cell
from visitlab_cli.errors import UsageError
from visitlab_cli.log.reader import read_steps
from visitlab_cli.results.export import export_table, for_spreadsheets
from visitlab_cli.storage.arrays import read_trials


def read_csv(file):
    with file.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def test_trials_as_csv(tiny_run, tmp_path):
    done = visitlab("export", tiny_run, "--csv", cwd=tmp_path)
    assert done.stdout == f"{tiny_run.name}-trials.csv: 852 rows, trials of 17 cells\n", done.stderr
    found = read_csv(tmp_path / f"{tiny_run.name}-trials.csv")
    mine = [row for row in found if (row["experiment"], row["human"]) == ("visit", "slow")]
    expected = read_trials(tiny_run / "visit/slow/seed-0000/trials.parquet")
    assert [float(row["reward"]) for row in mine] == expected["reward"].tolist()
    assert [int(row["goals"]) for row in mine] == expected["goals"].tolist()
    assert {(row["human"], row["goals"], row["seed"]) for row in found if row["experiment"] == "navigation"} == {
        ("", "", "0")
    }


def test_steps_as_parquet_of_chosen_cells(tiny_run, tmp_path):
    file = tmp_path / "steps.parquet"
    chosen = ["--experiment", "social", "--agent", "mf"]
    done = visitlab("export", tiny_run, "--parquet", "--table", "steps", *chosen, "-o", file, "--json")
    told = json.loads(done.stdout)
    steps = read_steps(tiny_run / "social/mf/fast/seed-0000/steps.mcap")
    assert (told["cells"], told["rows"], told["file"]) == (1, 1260, str(file))
    table = parquet.read_table(file)
    assert table.column_names == ["experiment", "agent", "human", "seed", *steps]
    assert np.array_equal(table.column("state").to_numpy(), steps["state"])
    assert set(table.column("action").to_pylist()[:1]) == {"NO_ACTION"}


def test_tasks_with_other_columns_make_one_table(tmp_path):
    run, cells = open_lab(tmp_path, seeds=1, more="vary: {agents.mf.alpha: [0.1, 0.5]}\n")
    chosen = list(cells.values())
    for number, cell in enumerate(chosen):
        write_cell(run, cell, [number, number + 0.5])
    for kind, read in (("csv", read_csv), ("parquet", lambda file: parquet.read_table(file).to_pylist())):
        file = tmp_path / f"x.{kind}"
        assert export_table(run, chosen, "trials", file) == 2 * len(chosen)
        rows = read(file)
        assert [float(row["reward"]) for row in rows[::2]] == list(range(len(chosen)))
        alphas = [row["agents.mf.alpha"] for row in rows[::2]]
        expected = [cell.config.agents["mf"].alpha if "=" in cell.path else None for cell in chosen]
        assert [float(alpha) if alpha not in ("", None) else None for alpha in alphas] == expected
        with pytest.raises(UsageError, match="exists"):
            export_table(run, chosen, "trials", file)


def test_results_are_a_row_a_group(tmp_path):
    run, cells = open_lab(tmp_path)
    chosen = [cells[f"navigation/mb/seed-000{seed}"] for seed in range(3)]
    for cell, value in zip(chosen, (1.0, 2.0, 6.0), strict=True):
        write_cell(run, cell, [value] * 20)
    assert export_table(run, chosen, "results", tmp_path / "x.csv") == 1
    (row,) = read_csv(tmp_path / "x.csv")
    assert (row["name"], float(row["mean"]), int(row["n"])) == ("navigation/mb", 3.0, 3)
    assert float(row["low"]) == pytest.approx(3 - 6.572, abs=1e-3)


def test_no_text_is_a_formula():
    formulas = ["=1+1", "@x", "+y", "-z", "\tq", "\rq", "\n=q", " =x", "-1_0", "\uff1d1", "--1"]
    others = ["plain", None, "-2", "+.5", "1e-3", "-inf", "a=b", ""]
    texts, safe = formulas + others, [f"'{text}" for text in formulas] + others
    arrays = [
        pyarrow.array(texts),
        pyarrow.array(texts, pyarrow.large_string()),
        pyarrow.array(texts).dictionary_encode(),
    ]
    numbers = pyarrow.array(range(-len(texts), 0))
    made = for_spreadsheets(pyarrow.table([*arrays, numbers], ["=text", "@large", "coded", "-1"]))
    assert made.column_names == ["'=text", "'@large", "coded", "-1"]
    assert all(made.column(place).to_pylist() == safe for place in range(3))
    assert made.column(3).to_pylist() == numbers.to_pylist()


@pytest.mark.parametrize(
    ("arguments", "code", "line"),
    [
        (["--csv", "--parquet"], 2, "choose one format: --csv, --parquet, --foxglove, --minari or --ros2bag"),
        (["--csv", "--table", "trails"], 2, "--table trails: no such table; did you mean trials?"),
        (["--csv", "-o", "x.parquet"], 2, "--output x.parquet: must end in .csv"),
        (
            ["--csv", "--trial", "3"],
            2,
            "a table holds all trials; choose cells by --experiment, --human, --agent, --seed, --at",
        ),
        (["--csv", "--human", "nobody"], 5, "no human nobody; known: fast, fast_pointing, slow"),
    ],
)
def test_what_does_not_work_is_one_line(tiny_run, tmp_path, arguments, code, line):
    done = visitlab("export", tiny_run, *arguments, cwd=tmp_path)
    assert (done.returncode, done.stdout) == (code, "")
    assert done.stderr.endswith(f"{line}\n")
    assert not list(tmp_path.iterdir())


def test_a_column_has_its_type_even_where_all_of_it_is_missing(tmp_path):
    """One seed has no interval, and an untrained cell no time; a run without a human has none anywhere."""
    run, cells = open_lab(tmp_path, seeds=1)
    for cell in cells.values():
        write_cell(run, cell, [1.0, 2.0])
    for content in ("results", "trials"):
        for chosen in (list(cells.values()), [cell for cell in cells.values() if not cell.human][:1]):
            file = tmp_path / f"{content}-{len(chosen)}.parquet"
            export_table(run, chosen, content, file)
            schema = parquet.read_schema(file)
            assert [column.name for column in schema if pyarrow.types.is_null(column.type)] == []
    kinds = {column.name: str(column.type) for column in parquet.read_schema(tmp_path / "results-1.parquet")}
    assert (kinds["low"], kinds["high"], kinds["seconds_a_cell"]) == ("double", "double", "double")
    assert (kinds["human"], kinds["n"]) == ("string", "int64")


@pytest.mark.parametrize("kind", ["--csv", "--parquet"])
def test_a_log_has_no_table(tiny_run, kind):
    log = tiny_run / "visit/fast/seed-0000/steps.mcap"
    done = visitlab("export", log, kind)
    message = f"{log}: is one log, and tables are of runs; choose another format, or a run\n"
    assert (done.returncode, done.stderr) == (2, message)
