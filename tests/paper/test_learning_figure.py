"""Fig. 6 and Fig. 8: what is drawn, read back from the axes, is what lies in the run."""

import csv
import shutil

import numpy as np
import pytest

from tests.paper_runs import CONFIGS, SEEDS, UNTIL
from tests.program import the_run, visitlab
from visitlab_cli.exact.navigation import navigation_optimum, navigation_random
from visitlab_cli.exact.social import optimum
from visitlab_cli.paper.figures.designs import FIG_6, FIG_8
from visitlab_cli.paper.figures.learning_figure import draw_fig6, draw_fig8, draw_learning
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.storage.arrays import read_trials

T_OF_ONE = 12.706205  # Student's t, 1 degree of freedom, 97.5%


@pytest.fixture(scope="module")
def drawings(paper_run):
    source = open_source(paper_run)
    return {"fig6": draw_fig6(source), "fig8": draw_fig8(source)}


@pytest.fixture(scope="module")
def beside(paper_run):
    """The same with the published curves beside those that are not as published, too."""
    source = open_source(paper_run)
    return {"fig6": draw_learning(source, FIG_6, even_so=True), "fig8": draw_learning(source, FIG_8, even_so=True)}


def rewards(run, group, cells="seed-*"):
    files = sorted((run / group).glob(f"{cells}/trials.parquet"))
    return np.stack([read_trials(file)["reward"] for file in files])


def panel(drawing, title):
    (axes,) = [axes for axes in drawing.figure.axes if axes.get_title(loc="left") == title]
    return axes


def line(axes, gid):
    (found,) = [each for each in axes.lines if each.get_gid() == gid]
    return found.get_xdata(), found.get_ydata()


def band(axes, gid):
    """The middle and the half width of a band, from its outline: there along the lower edge, back along the upper."""
    (area,) = [each for each in axes.collections if each.get_gid() == gid]
    ys = area.get_paths()[0].vertices[:, 1]
    batches = (len(ys) - 3) // 2
    low, high = ys[1 : batches + 1], ys[batches + 2 : -1][::-1]
    return (low + high) / 2, abs(high - low) / 2


PANELS = [("fig6", design) for design in FIG_6] + [("fig8", design) for design in FIG_8]


@pytest.mark.parametrize(("figure", "design"), PANELS, ids=[design.title for _, design in PANELS])
def test_our_curves_are_the_runs(drawings, paper_run, figure, design):
    axes = panel(drawings[figure], design.title)
    assert len(design.conditions) == 3
    for group in design.groups():
        ours = rewards(paper_run, group)
        assert len(ours) == SEEDS
        first = UNTIL // 20 if "mf_after_mb" in group else 0
        shown = ours[:, first:]
        if shown.shape[1] > 100:
            shown = shown.reshape(SEEDS, 100, -1).mean(axis=2)
        x, y = line(axes, group)
        per_trial = 1 if design.experiment == "visit" else 20
        batch = (ours.shape[1] - first) / shown.shape[1] * per_trial
        assert x == pytest.approx(first * per_trial + (np.arange(len(x)) + 0.5) * batch)
        assert y == pytest.approx(shown.mean(axis=0))
        interval = T_OF_ONE * shown.std(axis=0, ddof=1) / np.sqrt(SEEDS)
        middle, half = band(axes, f"interval/{group}")
        assert middle == pytest.approx(y)
        assert half == pytest.approx(interval, rel=1e-6)


@pytest.mark.parametrize(("figure", "design"), PANELS, ids=[design.title for _, design in PANELS])
def test_the_published_curves_are_the_published(beside, figure, design):
    from visitlab_cli import paper as analysis

    with open(f"{analysis.__path__[0]}/published/{design.published}.csv") as file:
        rows = list(csv.DictReader(file))
    assert {row["condition"] for row in rows} == {condition.published for condition in design.conditions}
    axes = panel(beside[figure], design.title)
    for condition, group in zip(design.conditions, design.groups(), strict=True):
        x, y = line(axes, f"published/{group}")
        mine = [row for row in rows if row["condition"] == condition.published]
        assert x.tolist() == [float(row.get("step") or row["trial"]) for row in mine]
        assert y.tolist() == [float(row["mean"]) for row in mine]
        middle, half = band(axes, f"published-band/{group}")
        assert middle == pytest.approx(y)
        assert half == pytest.approx([float(row["std"]) for row in mine])


def published_in(axes):
    names = [each.get_gid() or "" for each in axes.lines]
    return [name.removeprefix("published/") for name in names if name.startswith("published/")]


def test_what_is_not_as_published_has_no_published_curve_behind_it(drawings):
    watching = panel(drawings["fig6"], "Social, Human 1, after watching")
    assert published_in(watching) == ["social/mb/human_1", "social/mf/human_1"]
    told = "bootstrapped: mf_after_mb.until 600, published 500000"
    assert watching.get_xlabel().replace("\n", " ").endswith(f"not as published: {told}")
    assert f"Social, Human 1, after watching: not as published: {told}" in drawings["fig6"].notes
    visit = panel(drawings["fig8"], "Visit the lab, trained with Human 2")  # its modules are trained less
    assert published_in(visit) == []
    assert "navigation.steps 2000, published 500000" in visit.get_xlabel().replace("\n", " ")


@pytest.mark.slow
def test_a_human_with_other_values_has_no_published_curve_and_one_by_another_name_has(tmp_path):
    """A config as a user may have it: `human_2` edited, the published one kept as `shy`."""
    text = """
    name: mine
    include: [{configs}/humans/paper.yaml, {configs}/agents/paper.yaml]
    humans: {{shy: {{like: human_2}}}}
    experiments: {{social_humans: {{task: social, agents: [mb], humans: [human_1, shy, human_3], steps: 2000}}}}
    """
    (tmp_path / "mine.yaml").write_text(text.format(configs=CONFIGS))
    done = visitlab(
        "run", tmp_path / "mine.yaml", "humans.human_3.p_A=0.15", "--out", tmp_path / "runs", "--workers", 1, "--quiet"
    )
    assert done.returncode == 0, done.stderr
    drawing = draw_fig8(open_source(the_run(tmp_path / "runs")))
    axes = panel(drawing, "Social, three humans")
    assert published_in(axes) == ["social_humans/mb/human_1", "social_humans/mb/shy"]
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names == ["Human 1", "Human 2 (shy)", "Human 3"]
    assert "Social, three humans: not as published: Human 3: human_3.p_A 0.15, published 0.1" in drawing.notes


def test_reference_lines_are_exact_or_measured(drawings, paper_run):
    def heights(figure, title, kind):
        lines = panel(drawings[figure], title).lines
        return sorted(each.get_ydata()[0] for each in lines if each.get_gid() == f"reference/{kind}")

    assert heights("fig6", "Navigation", "optimum") == [navigation_optimum(20)]
    assert heights("fig6", "Navigation", "chance") == [navigation_random(20)]
    assert 15 < heights("fig6", "Go to human", "optimum")[0] < 20
    humans = open_source(paper_run).config.humans
    assert heights("fig6", "Social, Human 1", "optimum") == [optimum(humans["human_1"])]
    assert heights("fig6", "Social, Human 1", "script") == []
    three = sorted(optimum(humans[name]) for name in ("human_1", "human_2", "human_3"))
    assert heights("fig8", "Social, three humans", "optimum") == three
    assert len(heights("fig8", "Social, three humans", "chance")) == 1
    scripts = [
        rewards(paper_run, f"visit_script/{human}").mean() for human in ("human_1", "human_2", "human_2_pointing")
    ]
    assert heights("fig8", "Visit the lab, trained with Human 2", "script") == sorted(scripts)


def test_the_bootstrapped_learner_starts_at_a_marked_step(drawings):
    axes = panel(drawings["fig6"], "Social, Human 1, after watching")
    assert [each.get_xdata()[0] for each in axes.lines if list(each.get_xdata()) == [UNTIL, UNTIL]] == [UNTIL]


def test_axes_say_units_and_n(drawings):
    navigation = panel(drawings["fig6"], "Navigation")
    assert navigation.get_ylabel() == "reward of a trial of 20 steps\n(mean, n = 2 seeds)"
    assert navigation.get_xlabel() == "step of training (thousands)"
    visit = panel(drawings["fig8"], "Visit the lab, trained with Human 2")
    assert visit.get_ylabel() == "goal rooms in a trial of 100 steps\n(mean, n = 2 seeds)"
    assert visit.get_xlabel().splitlines()[0] == "trial"


def test_every_band_is_named(drawings):
    (key,) = drawings["fig6"].figure.legends
    names = [text.get_text().replace("\n", " ") for text in key.get_texts()]
    assert "this run: 95% interval of the mean (Student's t)" in names
    assert "published: standard deviation between the 10 seeds of single trials, not of the mean" in names


def test_crossed_visits_show_both_spreads(crossed_run):
    drawing = draw_fig8(open_source(crossed_run))
    axes = panel(drawing, "Visit the lab, trained with Human 2")
    assert axes.get_ylabel().endswith("(mean, n = 2 models, 4 visits)")
    notes = [text.get_text() for text in axes.texts if "between models" in text.get_text()]
    lines = notes[0].splitlines()
    assert lines[:2] == ["standard deviation in the last quarter", "between models, between visits"]
    assert [each.split(":")[0] for each in lines[2:]] == ["Human 1", "Human 2", "Human 2 with pointing"]
    ours = rewards(crossed_run, "visit/human_2", "model-*/seed-*").reshape(2, 2, -1)
    _, y = line(axes, "visit/human_2")
    assert y == pytest.approx(ours.mean(axis=(0, 1)))
    interval = T_OF_ONE * ours.mean(axis=1).std(axis=0, ddof=1) / np.sqrt(2)
    assert band(axes, "interval/visit/human_2")[1] == pytest.approx(interval, rel=1e-6)


def test_a_part_of_the_panels_and_cells(paper_run, tmp_path):
    run = tmp_path / "run"
    shutil.copytree(paper_run, run)
    shutil.rmtree(run / "go_to_human")
    shutil.rmtree(run / "navigation" / "rmax" / "seed-0001")
    drawing = draw_fig6(open_source(run))
    assert [note for note in drawing.notes if "not as published" not in note] == [
        "without go_to_human/rmax, go_to_human/mb, go_to_human/mf: not in this run",
        "navigation/rmax has 1 of 2 cells",
    ]
    titles = [axes.get_title(loc="left") for axes in drawing.figure.axes if axes.get_title(loc="left")]
    assert titles == ["Navigation", "Social, Human 1", "Social, Human 1, after watching"]
    assert panel(drawing, "Navigation").get_ylabel().endswith("(mean, n = 1 to 2 seeds)")
