"""Trainings and visits with hidden engagement: the same bytes however they are run, what is kept, and who reads it."""

import numpy as np
import pytest

from tests.program import hashes, only_cells, the_run, visitlab
from visitlab_cli.log.reader import read_steps
from visitlab_cli.world.social import parts_of

CONFIG = """
name: hidden
seed: 2
humans:
  fast: {p_S: [0, 0.5, 0.5], p_H: 0.05, p_M: 0.05, p_O: 0.15, p_A: 0.05}
  slow: {p_S: [1, 0, 0], p_M: 0.1, p_O: 0.1, p_P: 0.5}
agents:
  mf: {kind: q_learning}
  script: {kind: scripted}
experiments:
  navigation: {task: navigation, agents: [mf], steps: 400}
  go_to_human: {task: go_to_human, agents: [mf], steps: 400}
  social:
    task: social
    agents: [script]
    observe: geometry
    belief: {parameters: em}
    phases: [{steps: 400, human: fast}, {steps: 600, human: slow}]
  on:
    task: social
    agents: [script]
    observe: geometry
    belief: {parameters: em}
    humans: [slow]
    steps: 400
    start_from: social/script/phases
  sights: {task: social, agents: [script], humans: [fast], steps: 400, observe: geometry}
  visit:
    task: visit
    observe: geometry
    belief: {parameters: em}
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mf, social: social/script/phases}
    humans: [slow]
    trials: 3
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    file = tmp_path_factory.mktemp("hidden") / "hidden.yaml"
    file.write_text(CONFIG)
    return file


@pytest.fixture(scope="module")
def run(config):
    done = visitlab("run", config, "seeds=2", "--workers", 2, "--out", config.parent / "runs")
    assert done.returncode == 0, done.stderr
    return the_run(config.parent / "runs")


@pytest.mark.slow
def test_one_worker_uncompiled_and_what_is_added_later(run, config, tmp_path):
    for seeds, env in ((1, {"NUMBA_DISABLE_JIT": "1"}), (2, {})):
        done = visitlab("run", config, f"seeds={seeds}", "--workers", 1, "--out", tmp_path, env=env)
        assert done.returncode == 0, done.stderr
    assert only_cells(hashes(the_run(tmp_path))) == only_cells(hashes(run))


@pytest.mark.slow
def test_what_is_believed_of_people_is_kept_and_gone_on_from(run):
    first = np.load(run / "social/script/phases/seed-0000/model.npz")
    then = np.load(run / "on/script/slow/seed-0000/model.npz")
    visited = np.load(run / "visit/slow/seed-0000/model.npz")
    assert first["belief_parameters"].shape == (8,)
    for further in (then, visited):
        assert further["belief_sums"][7] > first["belief_sums"][7], "chances to move, counted on"
        assert further["belief_parameters"][0] > first["belief_parameters"][0], "slower than the first one"


@pytest.mark.slow
def test_no_truth_lies_beside_what_is_perceived(run):
    for options in ((), ("--intents",)):
        done = visitlab("affordances", run, "--experiment", "sights", *options)
        assert (done.returncode, done.stderr.count("\n"), "Traceback" in done.stderr) == (5, 1, False)


@pytest.mark.slow
def test_frozen_nothing_is_learned_of_people_either(run):
    done = visitlab("eval", run, "--frozen", "--trials", 2, "--json")
    assert done.returncode == 0, done.stderr
    (played,) = run.glob("evaluations/*/visit/slow/seed-0000/model.npz")
    kept, before = np.load(played), np.load(run / "social/script/phases/seed-0000/model.npz")
    assert (kept["belief_parameters"] == before["belief_parameters"]).all()


@pytest.mark.slow
def test_the_log_has_the_belief_and_the_truth(run):
    steps = read_steps(run / "social/script/phases/seed-0000/steps.mcap")
    now = np.stack([steps[f"belief_{name}"] for name in ("none", "greeted", "called", "following")])
    np.testing.assert_allclose(now.sum(axis=0), 1, atol=1e-5)
    assert (now[0][steps["step"] == 0] == 1).all()
    level = parts_of(steps["state"]).level
    assert (level != steps["interaction_level"]).any(), "sometimes it is wrong"
    assert "belief_none" not in read_steps(run / "sights/script/fast/seed-0000/steps.mcap")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["runs", "verify", "RUN"], ""),
        (["report", "RUN"], ""),
        (["metrics", "RUN", "--json"], "belief_right_engaged"),
        (["steps", "RUN", "--experiment", "visit", "--trial", "1"], "believed"),
        (["replay", "RUN", "--experiment", "visit", "--trial", "1", "--save", "OUT/trial.rrd"], ""),
        (["export", "RUN", "--experiment", "visit", "--trial", "1", "--foxglove", "--output", "OUT/trial.mcap"], ""),
        (["eval", "RUN", "--frozen", "--trials", "2"], ""),
    ],
)
def test_whoever_reads_runs_reads_one_with_a_belief(run, tmp_path, words, told):
    done = visitlab(*(word.replace("OUT", str(tmp_path)).replace("RUN", str(run)) for word in words))
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    assert told in done.stdout
