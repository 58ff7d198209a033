"""Rows are data: those that are shipped fit together, and what is wrong in a file of rows is told where it stands."""

import shutil
from pathlib import Path

import pytest

from tests.program import visitlab
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.config.loading import load
from visitlab_cli.errors import ConfigError, NotFoundError
from visitlab_cli.exact.social import optimum
from visitlab_cli.scores.anchors import best_of, check_best
from visitlab_cli.scores.asking import ask
from visitlab_cli.scores.contenders import contenders, floor
from visitlab_cli.scores.rows import read_rows, shipped_rows

ROWS = Path(__file__).with_name("rows")
ROOT = Path(__file__).parents[2]
BUILT_IN = ROOT / "configs" / "agents" / "built-in.yaml"


@pytest.fixture
def copied(tmp_path):
    return shutil.copytree(ROWS, tmp_path / "rows")


def test_the_shipped_rows_ask_of_every_task_and_each_can_be_judged():
    rows = read_rows()
    asked = ask(rows, floor(), 1)
    check_best(rows, list(rows.rows), asked)
    tasks = {cell.task for row in rows.rows for cells in asked.cells_of(rows, row) for cell in cells}
    assert tasks == {"navigation", "go_to_human", "social", "visit"}
    assert asked.unplayable == {}


def test_what_is_best_of_the_papers_humans_is_what_is_known_of_them():
    rows = read_rows()
    paper = load("paper").humans
    asked = ask(rows, floor(), 1)
    assert {name: asked.config.humans[name] for name in paper} == paper
    (cells,) = asked.cells_of(rows, "human_3")
    assert best_of(rows, rows.rows["human_3"], cells[0]).value == 6.32
    (cells,) = asked.cells_of(rows, "navigation")
    assert best_of(rows, rows.rows["navigation"], cells[0]).value == pytest.approx(18.0787, abs=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize("human", read_rows().optima)
def test_the_optima_of_the_rows_are_those_that_are_computed(human):
    asked = ask(read_rows(), floor(), 1)
    assert read_rows().optima[human] == pytest.approx(optimum(asked.config.humans[human]), abs=0.005)


def test_every_kind_of_ours_is_among_the_agents_that_the_page_shows():
    assert {each.parameters.kind for each in contenders(BUILT_IN)} == set(KINDS)


def test_the_page_is_of_the_rows_as_they_are():
    rows, page = read_rows(), (ROOT / "docs" / "scores.md").read_text()
    assert f"**{rows.label}**" in page, "the rows changed: raise `set` and write the page anew, as it says"
    assert all(row.question in page for row in rows.rows.values())
    assert all(f" {name} " in page for name in set(KINDS))


def test_a_set_has_the_largest_number_of_its_files_and_another_digest_for_another_rule(copied):
    rows = read_rows(copied)
    assert rows.number == 7
    file = copied / "10_tiny.yaml"
    file.write_text(file.read_text().replace("trials: 3", "trials: 4"))
    assert read_rows(copied).digest != rows.digest
    (copied / "20_more.yaml").write_text("set: 8\n")
    assert read_rows(copied).label.startswith("set 8 (")


@pytest.mark.parametrize(
    ("wrong", "line"),
    [
        ("set: 8\nhumans: {fast: {p_S: [1, 0, 0]}}", ":2:16: humans.fast: is something else in another file"),
        ("set: 8\nrowz: {}", ":2:7: rowz: unknown"),
        ("set: none", ":1:6: set: input should be a valid integer"),
        ("set: 8\nrows: {x: {question: x, of: [nothing/AGENT], measure: all}}", "no experiment is called nothing"),
        ("set: 8\nrows: {x: {question: x, of: [social/AGENT/fast], measure: all}}", "rows.x: needs `best`"),
        ("set: 8\nrows: {x: {question: x, of: [social/AGENT/fast], measure: most}}", "rows.x.measure: input should"),
    ],
)
def test_what_is_wrong_is_told_where_it_stands(copied, wrong, line):
    (copied / "20_wrong.yaml").write_text(wrong)
    with pytest.raises(ConfigError) as told:
        read_rows(copied)
    assert line in str(told.value)
    assert "20_wrong.yaml" in str(told.value)


def test_a_folder_without_rows_is_not_found(tmp_path):
    with pytest.raises(NotFoundError, match="no rows of a scorecard there"):
        read_rows(tmp_path)


def test_an_optimum_that_nobody_knows_is_told_before_anything_is_played(copied, tmp_path):
    file = copied / "10_tiny.yaml"
    file.write_text(file.read_text().replace("best: {value: 16.8, source: best known of a test}", "best: optimum"))
    done = visitlab("score", "random", "--rows", copied, "--out", tmp_path / "runs", "--seeds", 1)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1)
    assert done.stderr.startswith("visit/fast: no optimum of fast is known")
    assert not (tmp_path / "runs").exists()


def test_the_shipped_rows_lie_with_the_configs():
    assert shipped_rows() == ROOT / "configs" / "scores"
