"""`visitlab compare RUN --page`: the page on the paper, on runs whose trials are made up."""

import json
import re

import numpy as np
import pytest

from tests.paper.made_runs import make_run
from tests.program import visitlab
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.cell_folder import TRIALS

VISIT, NAVIGATION = "visit/human_1", "navigation/rmax"
SHIFT = 2.0
T_OF_NINE = 2.262157  # Student's t, 9 degrees of freedom, 97.5%


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    out = tmp_path_factory.mktemp("runs")
    make_run(out, {NAVIGATION: 0.0, VISIT: SHIFT}, name="main")
    make_run(out, {VISIT: 0.0}, name="fig8_planner", planner="restart")
    return out


@pytest.fixture(scope="module")
def page(runs):
    """The page of the main run, as one file with its pictures beside it."""
    done = visitlab("compare", "main", "--out", runs, "--page", runs / "docs" / "page.md", "--json")
    assert done.returncode == 0, done.stderr
    files = json.loads(done.stdout)["files"]
    assert files[0] == str(runs / "docs" / "page.md")
    assert [file.removeprefix(f"{runs}/docs/images/reproduction/") for file in files[1:]] == ["fig6.svg", "fig8.svg"]
    return (runs / "docs" / "page.md").read_text()


def rows(page, beginning):
    return [line for line in page.splitlines() if line.startswith(f"| {beginning}")]


def test_the_numbers_are_those_of_compare(runs, page):
    told = json.loads(visitlab("compare", "main", "--out", runs, "--json").stdout)["curves"]
    table = page.partition("## Verdicts")[2].partition("## ")[0]
    for curve, row in zip(told, table.split("\n")[4:], strict=False):
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert cells[1:3] == [curve["verdict"], str(curve["seeds"])]
        for part, cell in zip(curve["parts"].values(), cells[3:], strict=True):
            half = part["interval"][1] - part["difference"]
            assert cell.startswith(f"{part['difference']:+.2f} ± {half:.2f} ")
    assert "1 agree and 1 differ" in page


def test_the_pictures_are_beside_it(runs, page):
    pictures = re.findall(r"\]\((.*?)\)", page)
    assert pictures
    assert all((runs / "docs" / picture).read_bytes().startswith(b"<?xml") for picture in pictures)


def test_what_the_choice_moves(runs, page):
    """Seed by seed, as both runs have the same root seed."""
    main, variant = (next(runs.glob(f"{name}-*")) for name in ("main", "fig8_planner"))
    seeds = sorted(folder.name for folder in (main / VISIT).iterdir())
    first = [
        [read_trials(run / VISIT / seed / TRIALS)["reward"][:100].mean() for seed in seeds] for run in (main, variant)
    ]
    differences = np.subtract(first[1], first[0])
    half = T_OF_NINE * differences.std(ddof=1) / np.sqrt(len(seeds))
    moved, left = rows(page, "`fig8_planner`")
    assert moved.split(" | ")[1] == f"{differences.mean():+.2f} ± {half:.2f}"
    assert "`visit.planner_rewards: restart`" in moved
    assert left.count("✓") == 2
    assert left.endswith("| 4 / 0 / 0 |")


def test_the_cause_is_named(page):
    causes = [line for line in page.splitlines() if line.startswith("  - ")]
    assert len(causes) == 4
    for line in causes:
        assert re.search(
            r"differs: it agrees \(.\d\.\d\d ± \d\.\d\d\) with `visit.planner_rewards: restart` \(run fig8_planner-",
            line,
        )


def test_what_was_not_run_is_said_to_be(page):
    assert all("| not run |" in row for row in rows(page, "`fig8_training`"))
    assert all("| not run |" in row for row in rows(page, "`fig8_crossed`"))
    assert "unexplained:" not in page


def test_without_the_variant_nothing_is_called_unexplained(tmp_path):
    run = make_run(tmp_path, {VISIT: SHIFT}, name="alone")
    page = tmp_path / "page.md"
    done = visitlab("compare", run, "--page", page)
    assert done.returncode == 0, done.stderr
    assert "not explained by what was run; fig8_best_match, " in page.read_text()
    assert "unexplained:" not in page.read_text()


def test_the_same_page_again(runs, page):
    visitlab("compare", "main", "--out", runs, "--page", runs / "docs" / "page.md")
    assert (runs / "docs" / "page.md").read_text() == page


def test_wrong_words(runs, tmp_path):
    done = visitlab("compare", "main", "--out", runs, "--page", tmp_path / "page.html")
    assert (done.returncode, done.stderr) == (2, f"--page {tmp_path}/page.html: must end in .md\n")
    done = visitlab("compare", "main", "--out", runs, "--page", tmp_path / "page.md", "--by", "agent")
    assert (done.returncode, done.stderr) == (2, "--page: is for the published curves; leave OTHER and --by out\n")
    (tmp_path / "images").write_text("in the way")
    done = visitlab("compare", "main", "--out", runs, "--page", tmp_path / "page.md")
    message = f"{tmp_path}/images/reproduction/fig6.svg: can't be written: Not a directory\n"
    assert (done.returncode, done.stderr) == (4, message)
    assert not (tmp_path / "page.md").exists()
