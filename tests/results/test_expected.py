"""The table of a run: its means are over what is independent."""

from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.results.expected import results
from visitlab_cli.storage.run_folder import read_config


def test_a_mean_is_over_models_and_not_over_visits(tmp_path):
    run, cells = open_lab(tmp_path, models="crossed")
    reached = {"visit/slow/model-0000/seed-0000": 1.0}
    reached |= {f"visit/slow/model-0001/seed-000{seed}": 4.0 for seed in range(3)}
    plan = reach(run, cells, reached)
    found = {line.group: line for line in results(run, read_config(run), plan)}
    assert (found["visit/slow"].value, found["visit/slow"].done, found["visit/slow"].cells) == (2.5, 4, 9)
    assert found["visit/fast"].value is None


def test_a_line_of_a_grid_tells_condition_and_point(tmp_path):
    run, cells = open_lab(tmp_path, more="vary: {agents.mf.alpha: [0.1, 0.5]}\n")
    found = {line.group: line for line in results(run, read_config(run), list(cells.values()))}
    line = found["navigation/mf/agents.mf.alpha=0.1"]
    assert (line.condition, line.point) == ("navigation/mf", (("agents.mf.alpha", "0.1"),))
