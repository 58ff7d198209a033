"""What the tests of the report share: the page of the tiny run, and of a grid of long names."""

import pytest

from tests.results.runs_by_hand import VERSIONS, reach
from visitlab_cli.config.loading import load_text
from visitlab_cli.plan.cells import plan
from visitlab_cli.report.making import make_report
from visitlab_cli.storage.run_folder import open_run

HUMAN = "a_human_who_is_slow_and_distractible_and_needs_a_lot_of_pointing"
AGENT = "MyModelBasedAgentWithTheLongestNameThatAConfigCanGiveToOneOfThem"
GRID = f"""
name: a-grid-with-a-name-as-long-as-a-name-can-be-which-is-64-letters
seeds: 2
humans:
  {HUMAN}: {{p_S: [1, 0, 0]}}
  fast: {{p_S: [0, 0, 1]}}
agents:
  {AGENT}: {{kind: model_based}}
  mf: {{kind: q_learning}}
experiments:
  navigation: {{task: navigation, agents: [mf], steps: 400}}
  go_to_human: {{task: go_to_human, agents: [{AGENT}], steps: 400}}
  social: {{task: social, agents: [{AGENT}, mf], humans: [{HUMAN}, fast], steps: 400}}
  visit:
    task: visit
    modules: {{navigation: navigation/mf, go_to_human: go_to_human/{AGENT}, social: social/{AGENT}/{HUMAN}}}
    humans: [{HUMAN}, fast]
    trials: 20
vary:
  agents.{AGENT}.plan_every: [500, 100000]
  humans.{HUMAN}.p_S: [[1, 0, 0], [0.3333333333333333, 0.3333333333333333, 0.3333333333333334]]
  humans.fast.p_A: [0.0123456789, 0.2]
  interaction.distances: [[1, 2, 4, 5], [1, 2, 3, 4]]
record: {{steps: none}}
"""


@pytest.fixture(scope="session")
def tiny_page(tiny_run, tmp_path_factory):
    """The page of the tiny run, beside it; not to be changed."""
    return make_report(tiny_run, tmp_path_factory.mktemp("report") / "report.html")


@pytest.fixture(scope="session")
def grid_page(tmp_path_factory):
    """The page of a grid with more than fifty lines, whose names are as long as they can be; not to be changed."""
    out = tmp_path_factory.mktemp("grid")
    run, config = open_run(out, load_text(GRID, "grid.yaml"), VERSIONS)
    cells = {cell.path: cell for cell in plan(config)}
    reach(run, cells, {path: -1234.5 + 10 * place for place, path in enumerate(cells)})
    return make_report(run, out / "report.html")
