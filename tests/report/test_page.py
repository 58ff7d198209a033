"""The page as text: what it tells of a run, what it escapes, that it is closed to the network."""

import re

import numpy as np
import pytest

from tests.report.conftest import AGENT, HUMAN
from tests.report.parsed import Parsed
from tests.results.runs_by_hand import open_lab, reach
from visitlab_cli.config.loading import load_text
from visitlab_cli.report.best_trial import best_trials
from visitlab_cli.report.curves import batch_edges, charts_of
from visitlab_cli.report.differences import two_learners
from visitlab_cli.report.making import gather, make_report
from visitlab_cli.report.page import render
from visitlab_cli.report.sections import what_was_run
from visitlab_cli.results.curves import in_batches
from visitlab_cli.results.estimates import Estimate
from visitlab_cli.results.expected import Result
from visitlab_cli.results.marginal import Marginal
from visitlab_cli.results.pairs import Side
from visitlab_cli.storage.arrays import read_trials
from visitlab_cli.storage.run_folder import read_config, read_versions, run_name

HOSTILE = "</script><script>document.title='hurt'</script><img src=x onerror=alert(1)>\"'&"
NETWORK = re.compile(r"""https?:|//\w+\.|@import|url\(|\bsrc=|fetch\(|XMLHttp|WebSocket|importScripts|eval\(""")


SVG = "http://www.w3.org/2000/svg"
UNRECORDED = "record: {steps: none}\n"


def hostile(report):
    """A report in which every word that a config, a cell or a file of versions gives is an attack."""
    facts = report.facts
    lines = [
        line._replace(
            group=line.group._replace(
                path=HOSTILE + line.group.path, agent=HOSTILE, human=HOSTILE, point=((HOSTILE, HOSTILE),)
            )
        )
        for line in facts.summaries
    ]
    expected = {line.group.path: Result(HOSTILE, HOSTILE, 1, 1, 1.0, 1.0, 0.1) for line in lines}
    hurt = {line.group.path: new.group for line, new in zip(facts.summaries, lines, strict=True)}
    side = Side(HOSTILE, 1.0, 2)
    pairs = [
        pair._replace(
            where=HOSTILE,
            measure=HOSTILE,
            first=side,
            second=side,
            groups=tuple(hurt[group.path] for group in pair.groups),
        )
        for pair in facts.pairs
    ]
    scripts = [
        each._replace(group=hurt[each.group.path], script=hurt[each.script.path]) for each in facts.against_script
    ]
    marginals = [Marginal(HOSTILE, HOSTILE, HOSTILE, HOSTILE, HOSTILE, Estimate(1.0, 0.1), 2, [lines[0].group])]
    metrics = [each._replace(group=hurt[each.group.path]) for each in facts.metrics if each.group.path in hurt]
    assert metrics
    facts = facts._replace(
        name=HOSTILE,
        metrics=metrics,
        summaries=lines,
        expected=expected,
        pairs=pairs,
        against_script=scripts,
        marginals=marginals,
        versions={HOSTILE: [HOSTILE]},
    )
    charts = [
        chart._replace(title=HOSTILE, y=HOSTILE, curves=[curve._replace(name=HOSTILE) for curve in chart.curves])
        for chart in report.charts
    ]
    trials = [
        each | {"group": HOSTILE, "cell": HOSTILE, "captions": [HOSTILE] * len(each["captions"])}
        for each in report.trials
    ]
    return facts, charts, trials


def test_it_is_closed_to_the_network(tiny_page):
    page = tiny_page.read_text()
    parsed = Parsed(page)
    (policy,) = [meta["content"] for meta in parsed.attributes("meta") if "http-equiv" in meta]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in policy
    assert NETWORK.findall(page.replace(SVG, "")) == []
    assert {name for name, _ in parsed.elements} & {"link", "iframe", "img", "object", "base", "form"} == set()
    assert [each["href"][0] for each in parsed.attributes("a")] == ["#"] * len(parsed.attributes("a"))


def test_it_tells_what_was_run_and_what_came_out(tiny_run, tiny_page):
    parsed = Parsed(tiny_page.read_text())
    facts = gather(tiny_run).facts
    for line in facts.summaries:
        assert line.group.experiment in parsed.text
        assert f"{line.value.mean:.2f}" in parsed.text
    assert f"{len(facts.cells)} of {len(facts.cells)} cells" in parsed.text
    assert "Incomplete" not in parsed.text
    assert "visitlab run tiny.yaml" in parsed.text
    assert (tiny_run / "config.yaml").read_text() in "".join(parsed.words)
    for name, version in read_versions(tiny_run).items():
        assert f"{name} {version}" in " ".join(parsed.words)


def test_agents_are_compared_two_by_two(tmp_path):
    run, cells = open_lab(tmp_path)
    reach(
        run,
        cells,
        {f"navigation/{agent}/seed-000{seed}": n + seed for agent, n in (("mb", 1), ("mf", 11)) for seed in (0, 1, 2)},
    )
    words = " ".join(Parsed(render(*gather(run))).words)
    assert "Agents compared" in words
    assert "mf less mb" in words
    assert "+10.00 ± 2.27" in words  # 2.776 (4 degrees of freedom) times the root of 2/3
    assert "3 independent" in words


def test_a_script_is_compared_seed_by_seed_and_nowhere_else(tiny_run, tiny_page):
    facts = gather(tiny_run).facts
    assert {line.group.agent for line in facts.against_script} == {"mf", "mb", "rmax", "watcher", "chance"}
    assert "Learned against the script" in Parsed(tiny_page.read_text()).text
    others = [{group.agent for group in pair.groups} for pair in two_learners(facts)]
    assert others
    assert not any("script" in agents for agents in others)


def test_the_interactions_that_were_recorded_are_told_of_each_group(tiny_run, tiny_page):
    parsed = Parsed(tiny_page.read_text())
    told = [each for each in gather(tiny_run).facts.metrics if each.group.experiment == "visit"]
    assert {each.group.human for each in told} == {"fast", "slow"}
    heads = [each["data-label"] for each in parsed.attributes("td") if "data-label" in each]
    assert heads.count("Robot faces human") == len(gather(tiny_run).facts.metrics)
    gaze = told[0].values["robot_gaze"][0].mean
    assert f"{gaze:.0%}" in parsed.text[parsed.text.index("From the logs, means") :]
    assert f"visitlab metrics {gather(tiny_run).facts.name}" in parsed.text


def test_without_logs_there_are_no_interactions(grid_page):
    assert "Interactions" not in Parsed(grid_page.read_text()).text


def test_every_line_is_there_without_a_script_and_says_what_it_is_of(grid_page):
    parsed = Parsed(grid_page.read_text())
    lines = [int(row["data-line"]) for row in parsed.attributes("tr") if "data-line" in row]
    choices = parsed.data["choices"]
    assert sorted(lines) == list(range(len(choices["lines"])))
    assert not any("hidden" in attributes for _, attributes in parsed.elements)
    fixed = ["Task", "Experiment", "Module", "Agent", "Human"]
    heads = [*fixed, "plan_every", "p_S", "p_A", "distances"]
    assert choices["heads"] == heads
    of = [
        {
            head: [known[each] for each in places]
            for head, known, places in zip(heads, choices["values"], line, strict=True)
        }
        for line in choices["lines"]
    ]
    visit = next(each for each in of if each["Experiment"] == ["visit"])
    assert visit["Module"] == ["navigation/mf", f"go_to_human/{AGENT}", f"social/{AGENT}/{HUMAN}"]
    assert visit["Human"] == [HUMAN]
    assert visit["p_A"] == []
    assert {tuple(each["p_A"]) for each in of} >= {("0.0123456789",), ("0.2",)}
    for curve in (curve for chart in parsed.data["charts"] for curve in chart["curves"]):
        assert curve["line"] in lines


def test_nothing_is_compared_where_nothing_differs(tmp_path):
    run, cells = open_lab(tmp_path)
    reach(run, cells, {"navigation/mb/seed-0000": 1})
    assert "Agents compared" not in render(*gather(run))


def test_the_config_that_it_shows_is_the_same_run_again(tiny_run, tiny_page):
    parsed = Parsed(tiny_page.read_text())
    config = next(words for words in parsed.words if words.startswith("name: tiny\n"))
    assert run_name(load_text(config, "tiny.yaml")) == tiny_run.name


def test_every_word_from_outside_is_escaped(tiny_run):
    report = gather(tiny_run)
    harmless, attacked = Parsed(render(*report)), Parsed(render(*hostile(report)))
    assert {name for name, _ in attacked.elements} <= {name for name, _ in harmless.elements}
    assert not [each for _, attributes in attacked.elements for each in attributes if each.startswith("on")]
    assert len(attacked.attributes("script")) == 2
    assert attacked.text.count(" ".join(HOSTILE.split())) > len(report.facts.summaries)
    assert attacked.data["charts"][0]["title"] == HOSTILE
    assert attacked.scripts[""] == harmless.scripts[""]


def test_the_best_trial_of_each_visit_is_the_best(tiny_run):
    report = gather(tiny_run)
    assert [each["group"] for each in report.trials] == ["visit/fast", "visit/slow", "visit_scripted/fast_pointing"]
    for each in report.trials:
        rewards = read_trials(tiny_run / each["cell"] / "trials.parquet")["reward"]
        assert each["goals"] == rewards.max() == rewards[each["trial"]] == sum(each["columns"]["reward"][1:])
        assert {len(values) for values in [*each["columns"].values(), each["captions"]]} == {each["steps"] + 1}
        drawn = {role: shapes for role, shapes in each["scene"].items() if not role.endswith("says")}
        assert set(drawn) == {"robot", "human", "sight", "desired", "goal", "reached"}
        assert {len(shapes) for shapes in drawn.values()} == {each["steps"] + 1}
        reached = [step for step, shape in enumerate(drawn["reached"]) if shape]
        assert reached == [step for step, reward in enumerate(each["columns"]["reward"]) if step and reward]


def test_a_long_trial_is_cut_and_says_so(tiny_run, monkeypatch):
    monkeypatch.setattr("visitlab_cli.report.best_trial.MOST_STEPS", 10)
    monkeypatch.setattr("visitlab_cli.report.best_trial.MOST_TRIALS", 1)
    (each,) = best_trials(tiny_run, [line.group for line in gather(tiny_run).facts.summaries])
    assert (each["steps"], len(each["captions"]), len(each["columns"]["reward"])) == (100, 11, 11)
    assert all(step <= 10 for step, _ in each["moments"])


def test_without_steps_it_says_so(tmp_path):
    run, cells = open_lab(tmp_path, more=UNRECORDED)
    reach(run, cells, dict.fromkeys(cells, 1.0))
    parsed = Parsed(make_report(run).read_text())
    assert "No steps were recorded" in parsed.text
    assert parsed.data["trials"] == []


def test_of_a_run_begun_and_of_one_without_a_cell(tmp_path):
    run, cells = open_lab(tmp_path, seeds=2)
    assert "No cell is finished yet" in Parsed(make_report(run).read_text()).text
    reach(run, cells, {"navigation/mb/seed-0000": 3.0})
    parsed = Parsed(make_report(run).read_text())
    assert f"Incomplete: {len(cells) - 1} cells of {len(cells)} not run yet." in parsed.text
    assert "1 (1 of 2 cells)" in parsed.text
    assert [chart["title"] for chart in parsed.data["charts"]] == ["navigation"]


def test_the_intervals_are_students(tmp_path):
    run, cells = open_lab(tmp_path, seeds=3)
    reach(run, cells, {f"navigation/mb/seed-000{seed}": value for seed, value in enumerate((1.0, 2.0, 3.0))})
    (chart,) = charts_of(run, [line.group for line in gather(run).facts.summaries])
    (curve,) = chart.curves
    half = 4.302653 / np.sqrt(3)  # t of 2 degrees of freedom, deviation 1
    assert (curve.n, curve.end) == (3, 400)
    assert curve.mean == [2.0] * 20
    assert curve.half == pytest.approx([half] * 20, abs=1e-3)
    assert chart.bounds.optimum > 18
    assert f"2.00 ± {half:.2f}" in make_report(run).read_text()


def test_crossed_models_are_no_more_seeds(tmp_path):
    run, cells = open_lab(tmp_path, seeds=2, models="crossed", more=UNRECORDED)
    visits = [path for path in cells if path.startswith("visit/slow")]
    reach(run, cells, {path: float(place) for place, path in enumerate(visits)})
    (chart,) = charts_of(run, [line.group for line in gather(run).facts.summaries])
    assert len(visits) == 4
    assert [curve.n for curve in chart.curves] == [2]


@pytest.mark.parametrize(
    ("trials", "points", "sizes"),
    [(300, 30, {10}), (25_000, 100, {250}), (120, 15, {8}), (2_000, 100, {20}), (127, 15, {8, 9}), (7, 7, {1})],
)
def test_batches_are_few_and_equal_where_they_can_be(trials, points, sizes):
    edges = batch_edges(trials, 100)
    assert (edges[0], edges[-1], len(edges)) == (0, trials, points + 1)
    assert set(np.diff(edges)) == sizes


def test_the_last_batch_is_the_mean_of_the_last_trials():
    rewards = np.arange(300.0)
    batches = in_batches(rewards, batch_edges(300, 100))
    assert batches.mean() == rewards.mean()
    assert batches[-1] == rewards[-10:].mean()


def test_a_large_grid_stays_small(tmp_path, monkeypatch):
    run, cells = open_lab(tmp_path, more=UNRECORDED)
    reach(run, cells, dict.fromkeys(cells, 1.0))
    monkeypatch.setattr("visitlab_cli.report.curves.ALL_POINTS", 60)
    charts = charts_of(run, [line.group for line in gather(run).facts.summaries])
    assert {len(curve.mean) for chart in charts for curve in chart.curves} == {10}


def test_the_same_run_gives_the_same_bytes_wherever_it_lies(tiny_run, tiny_page, tmp_path):
    import shutil

    moved = tmp_path / "<b> moved"
    shutil.copytree(tiny_run, moved)
    for timing in moved.rglob("timing.json"):
        timing.unlink()
    assert make_report(moved).read_bytes() == tiny_page.read_bytes()
    assert make_report(moved).read_bytes() == tiny_page.read_bytes()
    assert read_config(moved).name in tiny_page.read_text()
    assert not [file for file in moved.iterdir() if file.name.startswith(".")]


IN_A_LAB = """
  swap:
    task: visit
    lab: house
    controller: [route, mask]
    learns: [social, navigation]
    modules: {navigation: walk/mb, go_to_human: go_to_human/mb, social: social/mb/slow}
    phases: [{trials: 2, human: slow}, {trials: 3, human: fast, lab: shut, doors: {AC: 0.5}}]
  walk: {task: navigation, agents: [mb], lab: house, steps: 400}
labs:
  house: {map: "AAabBB\\naAABBb\\ncCCCCc"}
  shut: {like: house, closed: [AB]}
"""


def test_what_was_run_says_lab_controller_and_phases(tmp_path):
    run, _ = open_lab(tmp_path, more=IN_A_LAB)
    told = what_was_run(gather(run).facts, "What was run").replace("<wbr>", "")
    visit = "lab: house; controller: route, mask; learns: social, navigation; phase 0: trials 2, human slow; phase 1: "
    assert visit + "trials 3, lab shut, doors AC 0.5, human fast<" in told
    assert "reach the goal room and stay there; lab: house<" in told
    assert "lead a human from goal room to goal room with the trained modules<" in told  # the other one, as by default
