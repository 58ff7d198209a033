"""What docs/replay.md says is what quickstart's log holds."""

from tests.replay.make_docs import (
    CELL,
    PAGE,
    PICTURE,
    STEP,
    STRIP,
    TRIAL,
    documented_trial,
    fact_lines,
    facts_of,
    run_quickstart,
)
from visitlab_cli.scene.moments import FACTS, facts, moments, strip_steps
from visitlab_cli.world.lab import paper_lab

LARGEST_PICTURE = 400_000
LINES_IN_PICTURE = 11
"""Moments that the picture has room for."""


def test_the_facts_of_the_page_are_the_logs(tmp_path):
    trial = documented_trial(run_quickstart(tmp_path))
    assert trial.cell == CELL
    page = PAGE.read_text()
    assert facts_of(page) == fact_lines(trial)
    assert f"Trial {TRIAL} of the visit" in page
    assert f"at step {STEP}:" in page
    found = facts(trial.steps, paper_lab())
    assert tuple(found) == FACTS
    shown = [moment.step for moment in moments(trial.steps, paper_lab())][:LINES_IN_PICTURE]
    assert set(found.values()) <= set(shown)
    assert set(found.values()) <= set(strip_steps(trial.steps, paper_lab()))


def test_the_pictures_are_there_and_not_large():
    for picture in (PICTURE, STRIP):
        assert f"](images/{picture.name})" in PAGE.read_text()
        assert 0 < picture.stat().st_size < LARGEST_PICTURE
