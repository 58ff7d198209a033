"""The generated pages are what they would be made as now, and what they show works."""

import re
import shutil

import pytest

from tests.docs.config_page import EXAMPLE
from tests.docs.log_page import log_page
from tests.docs.make import ROOT, pages
from tests.program import visitlab
from visitlab_cli.config.loading import load
from visitlab_cli.log.reader import read_steps
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.arrays import read_trials


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return pages(tmp_path_factory.mktemp("pages"))


@pytest.mark.parametrize(
    "path", ["docs/cluster.md", "docs/commands.md", "docs/config.md", "docs/log.md", "configs/schema.json"]
)
def test_the_page_is_current(path, made):
    assert (ROOT / path).read_text(encoding="utf-8") == made[path], "run `python -m tests.docs.make`"


def test_no_page_names_a_place_on_somebodys_machine():
    files = [file for file in [*ROOT.glob("docs/*.md"), *ROOT.glob("*.md")] if file.is_file()]
    assert len(files) > 4
    for file in files:
        assert not re.search(r"/(home|root|tmp|work|Users)/", file.read_text()), file


def test_the_config_page_says_of_each_setting_what_it_may_be(made):
    assert "| any |" not in made["docs/config.md"]
    assert "| `told` | true or false | false |" in made["docs/config.md"]


def test_the_example_of_the_config_page_does_what_the_page_says(tmp_path):
    (tmp_path / "example.yaml").write_text(EXAMPLE)
    groups = [cell.group for cell in plan(load(tmp_path / "example.yaml"))]
    assert [group for group in groups if group.startswith("social/mb")] == ["social/mb/slow"]
    assert len([group for group in groups if group.startswith("social/careless/slow/")]) == 3


def test_the_snippet_of_the_log_page_reads_a_log(tiny_run, tmp_path, monkeypatch, capsys):
    cell = tiny_run / "navigation" / "mb" / "seed-0000"
    shutil.copy(cell / "steps.mcap", tmp_path)
    monkeypatch.chdir(tmp_path)
    (snippet,) = re.findall(r"```python\n(.*?)```", log_page(), re.DOTALL)
    exec(snippet, {})
    told = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert sum(float(reward) for _, _, reward in told) == read_trials(cell / "trials.parquet")["reward"].sum() > 0


FORMULAS = {
    "navigation/mb": "in navigation",
    "go_to_human/mb": "in go_to_human",
    "social/mb/fast": "in social and visit",
}


@pytest.mark.parametrize(("cell", "words"), FORMULAS.items())
def test_the_log_page_tells_how_the_state_counts(cell, words, tiny_run):
    steps = read_steps(tiny_run / cell / "seed-0000" / "steps.mcap")
    formula = re.search(rf"{words} `(.*?)`", log_page())[1]
    values = {name: column.astype(int) for name, column in steps.items()}
    names = {"row": "robot_row", "col": "robot_col", "level": "interaction_level"}
    values |= {short: values[name] for short, name in names.items() if name in values}
    assert len(set(values["state"])) > 20
    assert (eval(formula, {}, values) == values["state"]).all()


def test_every_command_is_on_its_page(made):
    listed = set(re.findall(r"^### visitlab (\S+)", made["docs/commands.md"], re.MULTILINE))
    in_help = set(re.findall(r"^│ (\w[\w-]*) ", visitlab("--help").stdout, re.MULTILINE))
    assert listed == in_help
