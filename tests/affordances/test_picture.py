"""The picture of the affordances: what is drawn, read back, is what `affordances` found."""

import dataclasses

import numpy as np
import pytest

from tests.pictures.within import beyond, upon_another, words_of
from visitlab_cli.affordances.learned import affordances
from visitlab_cli.affordances.maps_picture import colour_of
from visitlab_cli.affordances.picture import draw_affordances, save_affordances
from visitlab_cli.affordances.plain import ARROWS, weight
from visitlab_cli.affordances.policy import UNSEEN
from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.pictures.style import STYLE, styled
from visitlab_cli.plan.cells import plan
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.enums import N_LEVELS, N_MOVES

WITHOUT_BREAKS = str.maketrans("", "", " _\n")
CHANGED = 0.5
"""Points: an outline that is thicker says that the action changed."""


@pytest.fixture(scope="module")
def found(paper_run):
    return affordances(paper_run, plan(read_config(paper_run)))


@pytest.fixture(scope="module")
def panels(found):
    """The axes in their order: learned, true, the visits' changes, a row of maps for each policy."""
    axes = draw_affordances(found).axes
    visits = len(found.adaptations)
    assert visits == 3
    assert len(axes) == 2 + visits + N_LEVELS * (1 + visits)
    return axes


def texts(axes):
    return {text.get_gid(): " ".join(text.get_text().split()) for text in axes.texts if text.get_gid()}


def test_the_learned_graph(found, panels):
    written = texts(panels[0])
    for arrow in ARROWS:
        expected = weight(found.knows, arrow)
        said = f"{expected.learned:.3f} ({expected.visits:,})" if expected.visits else "never tried"
        at = f"{arrow.kind}/{int(arrow.level)}/{arrow.outcome}"
        if at in written:
            assert written[at].endswith(said)
        else:
            assert f"{arrow.kind}: {said}" in written["losses"]


def test_the_true_graph(found, panels):
    written = texts(panels[1])
    for arrow in ARROWS:
        expected = weight(found.knows, arrow)
        said = "never tried" if not expected.visits else "varies" if np.isnan(expected.low) else f"{expected.low:.3f}"
        at = f"{arrow.kind}/{int(arrow.level)}/{arrow.outcome}"
        assert said in (written[at] if at in written else written["losses"])


def test_what_a_visit_changed(found, panels):
    for axes, visit in zip(panels[2:5], found.adaptations, strict=True):
        drawn = {line.get_gid(): line.get_xdata() for line in axes.lines if line.get_gid()}
        for name, graph in (("before", found.knows), ("after", visit.knows)):
            np.testing.assert_array_equal(drawn[name], [weight(graph, arrow).learned for arrow in ARROWS])
        truth = [weight(visit.saw, arrow) for arrow in ARROWS]
        np.testing.assert_allclose(drawn[f"true/{visit.cell.human}"], [(each.low + each.high) / 2 for each in truth])


def test_it_says_why_one_arrow_has_two_true_values(found):
    twice = [
        arrow
        for arrow in ARROWS
        for visit in found.adaptations
        if visit.cell.human == found.cell.human and weight(found.knows, arrow).low != weight(visit.saw, arrow).low
    ]
    assert twice, "the training and the visit tried at other distances"
    said = " ".join(text.get_text() for text in draw_affordances(found).texts)
    assert "one arrow can have two true values" in said
    assert "two true values" not in " ".join(
        text.get_text() for text in draw_affordances(found._replace(adaptations=[])).texts
    )


def test_the_maps(found, panels):
    policies = [found.policy, *(visit.policy for visit in found.adaptations)]
    maps = np.array(panels[5:]).reshape(len(policies), N_LEVELS)
    for policy, row in zip(policies, maps, strict=True):
        for level, axes in enumerate(row):
            shown = {tuple(map(int, patch.get_gid().split("/"))): patch for patch in axes.patches if patch.get_gid()}
            seen = zip(*(policy.action[level] != UNSEEN).nonzero(), strict=True)
            assert set(shown) == {(level, d, b, policy.action[level, d, b]) for d, b in seen}
            for (_, distance, bearing, action), wedge in shown.items():
                assert wedge.theta1 % 360 == pytest.approx((90 + 45 * bearing - 22.5) % 360)
                assert np.all(np.array(wedge.get_facecolor()[:3]) >= np.array(colour_of(action)) - 1e-9)
                changed = policy is not found.policy and found.policy.action[level, distance, bearing] != action
                assert (wedge.get_linewidth() > CHANGED) == changed
            arrows = sum(len(each.U) for each in axes.collections)
            assert arrows == sum(action < N_MOVES for _, _, _, action in shown)


@pytest.mark.parametrize("kind", ["svg", "png", "pdf"])
def test_the_same_bytes_and_a_module_that_nobody_visited_with(found, tmp_path, kind):
    found = found._replace(adaptations=[])
    files = [tmp_path / f"{name}.{kind}" for name in "ab"]
    for file in files:
        save_affordances(found, file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_where_it_cannot_go(found, tmp_path):
    with pytest.raises(UsageError) as wrong:
        save_affordances(found, tmp_path / "picture.gif")
    assert str(wrong.value) == f"--picture {tmp_path}/picture.gif: must end in .svg, .png, .pdf"
    (tmp_path / "file").write_text("")
    with pytest.raises(RunError) as blocked:
        save_affordances(found, tmp_path / "file" / "picture.svg")
    assert str(blocked.value) == f"{tmp_path}/file/picture.svg: can't be written: File exists"


@pytest.mark.parametrize(
    "name", ["slow_and_distractible", "teenager_who_is_slow_and_very_distractible_and_needs_pointing_64", "W" * 64]
)
def test_long_names_are_whole_and_free(found, name):
    renamed = [each._replace(cell=dataclasses.replace(each.cell, human=name)) for each in found.adaptations]
    found = found._replace(cell=dataclasses.replace(found.cell, human=name), adaptations=renamed)
    with styled(STYLE):
        figure = draw_affordances(found)
    words = words_of(figure)
    assert beyond(figure, words) == []
    named = [text for text, _ in words if name.translate(WITHOUT_BREAKS) in text.translate(WITHOUT_BREAKS)]
    assert len(named) == 2 + 2 * len(renamed) + 1
    assert upon_another(words) == []
