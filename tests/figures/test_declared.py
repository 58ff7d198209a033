"""The figure that a config declares: which one is drawn, what its curves and bars say, and that it can be read."""

import numpy as np
import pytest

from tests.pictures.within import beyond, upon_another, words_of
from tests.program import visitlab
from tests.results.runs_by_hand import VERSIONS, open_lab, write_cell
from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.loading import load
from visitlab_cli.errors import NotFoundError
from visitlab_cli.figures import making
from visitlab_cli.figures.curves_figure import draw_curves, panels_of
from visitlab_cli.figures.making import DRAW, make_figures
from visitlab_cli.figures.meetings_figure import NOTE, draw_meetings
from visitlab_cli.figures.phases_figure import draw_phases
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.pictures.style import STYLE, styled
from visitlab_cli.plan.cells import plan
from visitlab_cli.results.phases import meetings
from visitlab_cli.storage.run_folder import open_run, read_config

BEYOND = {
    "adaptation": "curves", "coordination": "curves", "doors": "doors", "exploration": "curves", "friends": "meetings",
    "hidden": "visits", "labs": "visits", "leading": "visits", "planners": "curves", "strangers": "visits",
    "symmetry": "curves",
}  # fmt: skip
NEW = ("adaptation", "coordination", "exploration", "friends", "planners", "strangers", "symmetry")
T_OF_TWO = 4.302653  # Student's t, 2 degrees of freedom, 97.5%
OTHER = """
  other:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    humans: [slow, fast]
    trials: 20
    trial_steps: 10
"""
PHASES = """
  friends:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    phases: [{trials: 30, human: slow}, {trials: 30, human: fast}, {trials: 40, human: slow}, {trials: 10, human: slow}]
    trial_steps: 10
"""


def written(tmp_path, reward, more="", **settings):
    """The lab's config and more, each trial of a cell with the reward that `reward` gives the cell."""
    run, cells = open_lab(tmp_path, more=more, **settings)
    for cell in cells.values():
        write_cell(run, cell, np.resize(reward(cell), cell.trials))
    return run


def lines(axes):
    return {line.get_gid(): line for line in axes.lines if line.get_gid()}


@pytest.mark.parametrize("file", sorted((shipped_folder() / "beyond").glob("*.yaml")), ids=lambda file: file.stem)
def test_each_config_beyond_the_paper_asks_a_question_and_calls_only_who_is_there(file):
    config = load(file)
    assert config.figure.draws == BEYOND[file.stem]
    assert config.figure.question.endswith("?")
    known = {*config.experiments, *config.agents, *config.humans}
    assert {*config.figure.names, *config.figure.dashed, *config.figure.dashed.values()} <= known
    assert f"visitlab figures {file.stem}\n" in file.read_text()


@pytest.mark.parametrize("name", NEW)
def test_their_figures_can_be_read(name, tmp_path):
    config = load(shipped_folder() / "beyond" / f"{name}.yaml", ["seeds=1"])
    run, _ = open_run(tmp_path, config, VERSIONS)
    for number, cell in enumerate(plan(config)):
        if cell.settings.assembled or cell.task == "social":
            write_cell(run, cell, np.full(cell.trials, 3 + 0.37 * (number % 17)))
    source = open_source(run)
    with styled(STYLE):
        figure = DRAW[config.figure.draws](source).figure
        making._ask(figure, config.figure.question)
        words = words_of(figure)
        assert beyond(figure, words) == []
        assert upon_another(words) == []
    told = [text.replace("\n", " ") for text, box in words if box.width > 1]  # seen
    assert config.figure.question in told
    twice = [called for called in config.figure.names.values() if told.count(called) > 1]
    assert twice == []


def test_a_curve_is_the_mean_over_seeds_with_its_interval(tmp_path):
    figure = "figure: {question: 'Who?', draws: curves, names: {mb: the model}, dashed: {mf: mb}}\n"
    run = written(tmp_path, lambda cell: [10 * (cell.agent == "mb") + cell.seed], more=figure)
    (axes,) = [axes for axes in draw_curves(open_source(run)).figure.axes if axes.lines]
    assert (axes.get_title(loc="left"), axes.get_xlabel()) == ("navigation", "step of training (thousands)")
    assert axes.get_ylabel() == "reward of a trial of 20 steps\n(mean, n = 3 seeds)"
    drawn = lines(axes)
    assert drawn["navigation/mb"].get_ydata() == pytest.approx(np.full(20, 11.0))
    assert drawn["navigation/mf"].get_ydata() == pytest.approx(np.full(20, 1.0))
    assert drawn["navigation/mb"].get_xdata()[:2] == pytest.approx([10, 30])
    assert drawn["navigation/mf"].get_color() == drawn["navigation/mb"].get_color()
    assert (drawn["navigation/mb"].get_linestyle(), drawn["navigation/mf"].get_linestyle()) == ("-", "--")
    band = axes.collections[0].get_paths()[0].vertices
    assert band[:, 1].max() - band[:, 1].min() == pytest.approx(2 * T_OF_TWO / np.sqrt(3), rel=1e-5)
    (key,) = axes.figure.legends
    assert [text.get_text() for text in key.get_texts()] == ["the model", "mf"]
    assert key.get_title().get_text().startswith("each point: the mean of 1 trials;")


def test_visits_are_drawn_where_they_are_more_and_share_their_axis(tmp_path):
    run = written(tmp_path, lambda cell: [4.0 if cell.human == "slow" else 8.0], more=OTHER)
    source = open_source(run)
    assert [*panels_of(source, visits=False)] == [("navigation", "")]
    assert {place: [*found] for place, found in panels_of(source, visits=True).items()} == {
        ("", "slow"): ["visit", "other"],
        ("", "fast"): ["visit", "other"],
    }
    slow, fast = (axes for axes in draw_curves(source).figure.axes if axes.lines)
    assert (slow.get_title(loc="left"), fast.get_title(loc="left")) == ("slow", "fast")
    assert slow.get_ylim() == fast.get_ylim() == pytest.approx((0, 8.64))
    assert (slow.get_ylabel().split("\n")[0], fast.get_ylabel()) == ("goal rooms in a trial of 10 steps", "")


MORE_TRAININGS = """
  more:
    task: visit
    modules: {navigation: navigation/mf, go_to_human: go_to_human/mb, social: social/mb/slow}
    humans: [fast]
    trials: 20
    trial_steps: 10
  social_of_all: {task: social, agents: [mb, mf], humans: [slow, fast], steps: 400}
"""


def test_visits_without_phases_are_drawn_whatever_else_there_is_and_what_is_left_out_is_said(tmp_path):
    """Five curves of trainings, two of visits with `fast`; `slow` is visited once, `friends` has phases."""
    figure = "figure: {question: 'Who?', draws: curves, costs: true, names: {fast: the fast one}}\n"
    run = written(tmp_path, lambda cell: [4.0 + 4 * cell.settings.assembled], more=PHASES + MORE_TRAININGS + figure)
    drawing = draw_curves(open_source(run))
    panels = {axes.get_title(loc="left"): [*lines(axes)] for axes in drawing.figure.axes if axes.lines}
    assert panels == {
        "navigation": ["navigation/mb", "navigation/mf"],
        "social_of_all, slow": ["social_of_all/mb/slow", "social_of_all/mf/slow"],
        "social_of_all, the fast one": ["social_of_all/mb/fast", "social_of_all/mf/fast"],
        "visits, the fast one": ["visit/fast", "more/fast"],
    }
    (key,) = drawing.figure.legends
    assert {text.get_text() for text in key.get_texts()} == {"mb", "mf", "visit", "more"}
    assert drawing.notes == [
        "without visit/slow (the only visit of its human), "
        "friends (with phases, which the figures phases and meetings draw)",
        "without costs, which are of trainings alone",
    ]


@pytest.mark.parametrize("draw", [draw_curves, draw_phases], ids=["curves", "phases"])
def test_no_shade_is_cut_off_and_panels_of_one_measure_have_one_axis(draw, tmp_path):
    """Of three seeds one reaches nothing: intervals end far above each mean."""
    other = OTHER + PHASES + PHASES.replace("friends", "strangers")
    high = {"visit": 1.0, "friends": 4.0}
    run = written(tmp_path, lambda cell: [high.get(cell.experiment, 8.0) * (cell.seed > 0)], more=other)
    panels = [axes for axes in draw(open_source(run)).figure.axes if axes.lines]
    assert len(panels) == 2
    assert len({axes.get_ylim() for axes in panels}) == 1
    highest = max(shade.get_paths()[0].vertices[:, 1].max() for axes in panels for shade in axes.collections)
    assert highest == pytest.approx(8 * (2 / 3 + T_OF_TWO / 3))
    assert highest < panels[0].get_ylim()[1] < 1.2 * highest


def test_costs_stand_beside_the_curves(tmp_path):
    figure = "figure: {question: 'Who?', draws: curves, costs: true, names: {mf: without a model}}\n"
    run = written(tmp_path, lambda cell: [1.0], more=figure)
    curves, updated, core = draw_curves(open_source(run)).figure.axes
    assert [*lines(curves)] == ["navigation/mb", "navigation/mf"]
    assert [tick.get_text() for tick in updated.get_yticklabels()] == ["mb", "without a model"]
    assert [*lines(updated)["cost/updates/mf"].get_xdata()] == [1.0]
    assert [*lines(updated)["cost/updates/mb"].get_xdata()] == [5184 * 25 / 1000]  # all pairs, every 1000 steps
    assert not lines(core)  # nobody measured it
    assert updated.get_xlabel() == "values updated\na step, in the end"


def test_meetings_are_with_who_is_new_and_who_comes_again(tmp_path):
    trials = np.concatenate([np.full(30, 9.0), np.full(20, 1.0), np.full(10, 2.0), np.full(20, 3.0), np.full(20, 4.0)])
    reward = lambda cell: np.append(trials, np.full(10, 7.0)) if cell.experiment == "friends" else [0.0]  # noqa: E731
    run = written(tmp_path, reward, more=PHASES)
    source = open_source(run)
    found = meetings(run, source.groups["friends/phases"].cells)
    assert [values.tolist() for values in found[:4]] == [[1.0] * 3, [2.0] * 3, [3.0] * 3, [4.0] * 3]
    figure = draw_meetings(source).figure
    assert [axes.get_title(loc="left") for axes in figure.axes] == [
        "new: first 20 trials", "new: the rest", "met again: first 20", "met again: the rest",
    ]  # fmt: skip
    assert [[bar.get_width() for bar in axes.patches] for axes in figure.axes] == [[1.0], [2.0], [3.0], [4.0]]
    assert len({axes.get_xlim() for axes in figure.axes}) == 1
    assert [tick.get_text() for tick in figure.axes[0].get_yticklabels()] == ["friends"]
    assert figure.get_supxlabel() == NOTE


def test_how_many_of_the_new_humans_the_robot_was_trained_with_is_said(tmp_path):
    """Nothing of `friends`, trained with `slow` alone; a pool knows `fast`, and so does a training that went on."""
    trainings = """
  others: {task: social, agents: [mb], humans: [fast], steps: 400}
  on: {task: social, agents: [mb], humans: [slow], steps: 400, start_from: others/mb/fast}
"""
    modules = "social: social/mb/slow"
    pool = PHASES.replace("friends", "pooled").replace(modules, "social: {pool: [social/mb/slow, others/mb/fast]}")
    went_on = PHASES.replace("friends", "went_on").replace(modules, "social: on/mb/slow")
    figure = "figure: {question: 'Who?', draws: meetings, names: {pooled: from a pool}}\n"
    run = written(tmp_path, lambda cell: [1.0], more=PHASES + pool + went_on + trainings + figure)
    assert draw_meetings(open_source(run)).figure.get_supxlabel() == (
        f"{NOTE}\ntrained with 1 of the 1 new humans: from a pool; went_on"
    )


def test_no_meetings_without_somebody_who_comes_again(tmp_path):
    once = PHASES.replace("{trials: 40, human: slow}, {trials: 10, human: slow}", "{trials: 50, human: fast}")
    run = written(tmp_path, lambda cell: [1.0], more=once)
    assert draw_meetings(open_source(run)).figure is None


def test_the_declared_figure_alone_is_drawn_below_its_question(tmp_path, capsys):
    figure = "figure: {question: 'What is it worth?', draws: curves, names: {mb: the model}}\n"
    run = written(tmp_path, lambda cell: [1.0], more=figure)
    words = (run / "config.yaml").read_text()
    assert "{mb: the model}" in words
    (run / "config.yaml").write_text(words.replace("{mb: the model}", "{mbb: the model}"))
    done = visitlab("figures", run)
    assert (done.returncode, done.stdout) == (0, f"{run}/figures/curves.svg\n")
    assert done.stderr.splitlines() == [
        "curves: without visit/slow, visit/fast (the only visit of its human)",
        "curves: figure: no experiment, agent or human is called mbb",
    ]
    assert make_figures(run, None, ["fig6"], "png").files[0].name == "fig6.png"
    source = open_source(run)
    drawing = draw_curves(source).figure
    before = drawing.get_figheight()
    making._ask(drawing, source.config.figure.question)
    assert drawing.get_suptitle() == "What is it worth?"
    assert drawing.get_figheight() > before


def test_a_run_without_what_it_needs_says_so(tmp_path):
    run, _ = open_lab(tmp_path, more="figure: {question: 'Who?', draws: meetings}\n")
    with pytest.raises(NotFoundError) as caught:
        make_figures(run, None)
    needs = "meetings needs phases in which a human comes again, as in configs/beyond/friends.yaml"
    assert str(caught.value) == f"{run}: holds nothing for meetings; {needs}"


def test_a_figure_changes_no_run_and_its_words_are_taken_over(tmp_path):
    run, _ = open_lab(tmp_path)
    plain = load(tmp_path / "lab.yaml")
    again, _ = open_lab(tmp_path, more="figure: {question: 'Who?', draws: curves}\n")
    told = load(tmp_path / "lab.yaml")
    assert (again, config_hash(told)) == (run, config_hash(plain))
    assert read_config(run).figure == told.figure
    open_run(tmp_path, plain, VERSIONS)
    assert read_config(run).figure == told.figure  # who says nothing leaves it


@pytest.mark.parametrize(
    ("figure", "message"),
    [
        ("{question: '', draws: curves}", "figure.question: must be a line of 1 to 200 characters (got 0)"),
        ("{question: 'a\\nb?', draws: curves}", "figure.question: must be a line of 1 to 200 characters (got 4)"),
        ("{question: 'Who?', draws: pies}", "figure.draws: must be curves, doors, grid, meetings, phases or visits"),
        ("{question: 'Who?', draws: curves, names: {mb: ''}}", "figure.names.mb: must be a line of 1 to 60 characters"),
    ],
)
def test_a_wrong_figure_is_one_line(figure, message, tmp_path):
    file = tmp_path / "lab.yaml"
    open_lab(tmp_path)
    file.write_text(file.read_text() + f"figure: {figure}\n".replace("'a\\nb?'", '"a\\nb?"'))
    done = visitlab("validate", file)
    assert done.returncode == 3
    assert f": {message}" in done.stderr
    assert len(done.stderr.splitlines()) == 1
