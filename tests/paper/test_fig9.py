"""Fig. 9: the choice of the trial, and what is asked of the strip."""

from visitlab_cli.log.reader import read_trial
from visitlab_cli.paper.figures.fig9 import draw_fig9, telling_trial
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.scene.moments import FACTS, moments, strip_steps
from visitlab_cli.world.lab import paper_lab

CELL = "visit/human_2/seed-0000"


def kinds(log, number):
    steps = read_trial(log, number)
    shown = strip_steps(steps, paper_lab())
    found = [moment.kind for moment in moments(steps, paper_lab()) if moment.step in shown]
    return len(set(found) & set(FACTS)), found.count("goal reached") + found.count("began in the goal room")


def test_the_trial_with_the_most_to_tell_is_chosen(paper_run):
    log = paper_run / CELL / "steps.mcap"
    told = [kinds(log, number) for number in range(12)]
    assert telling_trial(log, paper_lab()) == told.index(max(told))
    assert len(set(told)) > 1


def test_the_strip_gets_the_log_and_the_trial(paper_run):
    asked = []
    drawing = draw_fig9(open_source(paper_run), lambda log, trial: asked.append((log, trial)))
    log = paper_run / CELL / "steps.mcap"
    assert asked == [(log, telling_trial(log, paper_lab()))]
    assert drawing.notes == [f"shows {CELL}, trial {asked[0][1]}"]


def test_without_a_log_there_is_no_strip(crossed_run):
    drawing = draw_fig9(open_source(crossed_run), lambda log, trial: None)
    assert drawing.figure is None
    assert drawing.notes == ["visit/human_2/model-0000/seed-0000 has no log, the config records no steps"]
