"""The plan: which cells a config has, what they are called, and what they wait for."""

from visitlab_cli.config.loading import load
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.evaluation import Evaluation

CONFIG = """
name: grid
seeds: 2
humans:
  slow: {p_S: [1, 0, 0]}
  fast: {p_S: [0, 0, 1]}
agents:
  mb: {kind: model_based}
  mf: {kind: q_learning}
experiments:
  navigation: {task: navigation, agents: [mb, mf], steps: 40}
  go_to_human: {task: go_to_human, agents: [mb], steps: 40}
  social: {task: social, agents: [mb], humans: [slow], steps: 40}
  visit:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    humans: [slow, fast]
    trials: 3
"""


def cells(tmp_path, addition="", replace=("", ""), evaluation=None):
    file = tmp_path / "grid.yaml"
    file.write_text(CONFIG.replace(*replace) + addition)
    return {cell.path: cell for cell in plan(load(file), evaluation)}


def test_paths_and_needs(tmp_path):
    found = cells(tmp_path)
    assert list(found) == [
        "navigation/mb/seed-0000",
        "navigation/mb/seed-0001",
        "navigation/mf/seed-0000",
        "navigation/mf/seed-0001",
        "go_to_human/mb/seed-0000",
        "go_to_human/mb/seed-0001",
        "social/mb/slow/seed-0000",
        "social/mb/slow/seed-0001",
        "visit/slow/seed-0000",
        "visit/slow/seed-0001",
        "visit/fast/seed-0000",
        "visit/fast/seed-0001",
    ]
    visit = found["visit/fast/seed-0001"]
    assert visit.modules == {
        "navigation": "navigation/mf/seed-0001",
        "go_to_human": "go_to_human/mb/seed-0001",
        "social": "social/mb/slow/seed-0001",
    }
    assert visit.group == "visit/fast"
    assert visit.steps == 300


def test_first_and_crossed_models(tmp_path):
    first = cells(tmp_path, replace=("trials: 3", "trials: 3\n    models: first"))
    assert first["visit/fast/seed-0001"].modules["social"] == "social/mb/slow/seed-0000"
    crossed = cells(tmp_path, replace=("trials: 3", "trials: 3\n    models: crossed"))
    visits = [path for path in crossed if path.startswith("visit/fast")]
    assert visits == [f"visit/fast/model-000{model}/seed-000{seed}" for model in (0, 1) for seed in (0, 1)]
    cell = crossed["visit/fast/model-0001/seed-0000"]
    assert set(cell.modules.values()) == {
        "navigation/mf/seed-0001",
        "go_to_human/mb/seed-0001",
        "social/mb/slow/seed-0001",
    }
    assert cell.group == "visit/fast"


def test_a_grid_repeats_only_what_it_touches(tmp_path):
    found = cells(tmp_path, "vary: {agents.mf.alpha: [0.1, 0.5]}\n")
    assert len(found) == 2 + 4 + 2 + 2 + 8
    path = "visit/slow/agents.mf.alpha=0.1/seed-0000"
    assert found[path].modules["navigation"] == "navigation/mf/agents.mf.alpha=0.1/seed-0000"
    assert found[path].modules["social"] == "social/mb/slow/seed-0000"
    assert found["navigation/mf/agents.mf.alpha=0.1/seed-0000"].config.agents["mf"].alpha == 0.1
    assert "navigation/mb/seed-0000" in found


def test_a_grid_over_a_human_touches_who_trains_with_it(tmp_path):
    found = cells(tmp_path, "vary: {humans.fast.p_A: [0.1, 0.2]}\n")
    assert "visit/slow/seed-0000" in found
    assert "visit/fast/humans.fast.p_A=0.2/seed-0000" in found
    found = cells(tmp_path, "vary: {humans.slow.p_A: [0.1, 0.2]}\n")
    assert "social/mb/slow/humans.slow.p_A=0.2/seed-0001" in found
    assert "visit/fast/humans.slow.p_A=0.2/seed-0001" in found  # its social module was trained with slow


def test_an_evaluation_is_visits_only_elsewhere(tmp_path):
    found = cells(tmp_path, evaluation=Evaluation(("slow",), 5, frozen=True))
    assert len(found) == 2
    (path, cell), _ = found.items()
    assert path == f"{Evaluation(('slow',), 5, True).folder}visit/slow/seed-0000"
    assert (cell.steps, cell.frozen) == (500, True)
    assert cell.modules["social"] == "social/mb/slow/seed-0000"
    assert list(cells(tmp_path, evaluation=Evaluation())) == [path for path in cells(tmp_path) if "visit" in path]
