"""Several models by hand: whose each is, what is general and what specific, as values, words and a picture."""

import math

import numpy as np
import pytest
from matplotlib.colors import to_hex

from tests.pictures.within import beyond, upon_another, words_of
from visitlab_cli.affordances.counts import Kind
from visitlab_cli.affordances.graph_picture import PALE
from visitlab_cli.affordances.plain import Arrow, weight
from visitlab_cli.affordances.several import COMPARED, Belief, Verdict, as_json, of_saved, verdict
from visitlab_cli.affordances.several_picture import draw_several, save_several
from visitlab_cli.config.loading import load_text
from visitlab_cli.console.affordances import models_text
from visitlab_cli.errors import UsageError
from visitlab_cli.pictures.style import GREY, INK, STYLE, styled
from visitlab_cli.plan.cells import plan
from visitlab_cli.world.enums import Action, InteractionLevel
from visitlab_cli.world.scene import NOWHERE
from visitlab_cli.world.social import social_state

STATES, ACTIONS, TRIAL = 2560, 30, 100
CONFIG = """
name: several
humans:
  keen: {p_S: [1, 0, 0]}
  shy: {p_S: [1, 0, 0], p_P: 1, p_A: 0.25}
agents: {mb: {kind: model_based}, multi: {kind: multi_model}}
experiments:
  navigation: {task: navigation, agents: [mb], steps: 800}
  go_to_human: {task: go_to_human, agents: [mb], steps: 800}
  social: {task: social, agents: [multi], humans: [keen, shy], steps: 1200}
  visit:
    task: visit
    modules: {navigation: navigation/mb, go_to_human: go_to_human/mb, social: social/multi/keen}
    phases: [{trials: 10, human: keen}, {trials: 10, human: shy}, {trials: 10, human: keen}]
  from_both:
    task: visit
    modules:
      navigation: navigation/mb
      go_to_human: go_to_human/mb
      social: {pool: [social/multi/keen, social/multi/shy]}
    humans: [shy]
    trials: 30
"""
NEAR, FAR = 2, 4
COME, LOST = (
    Arrow(Kind.COME, InteractionLevel.GREETED, int(InteractionLevel.FOLLOWS)),
    next(arrow for arrow in COMPARED if arrow.kind is Kind.AWAY),
)


def at(level, distance=NEAR):
    scene = NOWHERE._replace(perceived_level=level, distance=distance, desired_direction=0, angle=0)
    return int(social_state(scene))


def model_of(seen):
    """The arrays of a model that has seen (level, distance, action, level next) so often, in the order of pairs."""
    visits, rows = np.zeros((STATES, ACTIONS)), {}
    for (level, distance, action, following), times in seen.items():
        pair = at(level, distance), int(action)
        visits[pair] += times
        rows.setdefault(pair, []).append((at(following), times))
    lengths = np.zeros(visits.size, np.int64)
    for (state, action), successors in rows.items():
        lengths[state * ACTIONS + action] = len(successors)
    followed = [each for pair in sorted(rows) for each in rows[pair]]
    return {
        "visits": visits,
        "reward_sums": np.zeros_like(visits),
        "successor_offsets": np.concatenate([[0], np.cumsum(lengths)]),
        "successor_states": np.array([state for state, _ in followed], np.int32),
        "successor_counts": np.array([times for _, times in followed], float),
    }


WEST = Action.MOVE_1_WEST
SEEN = (
    # keen: 3,000 came, of which 1,000 too far away, where all fail; it never lost attention
    {
        (5, NEAR, Action.COME, 7): 2000,
        (5, FAR, Action.COME, 0): 1000,
        (7, NEAR, WEST, 7): 400,
        (3, NEAR, Action.LOOK, 3): 600,
    },
    # shy: nobody came at once, a quarter of the steps lost it
    {
        (5, NEAR, Action.COME, 6): 400,
        (7, NEAR, WEST, 7): 300,
        (7, NEAR, WEST, 0): 100,
        (6, NEAR, Action.POINT, 7): 190,
        (6, NEAR, Action.POINT, 0): 10,
        (4, FAR, Action.STAY, 4): 100,
    },
)
SWITCHES = [[1100, 0, 1, 900], [2050, 1, 0, 2000]]


def saved_of(models=SEEN, switches=SWITCHES, active=0):
    made = [model_of(seen) for seen in models]
    starts = np.cumsum([0, *(len(each["successor_states"]) for each in made)])
    offsets = [each["successor_offsets"][:-1] + start for each, start in zip(made, starts, strict=False)]
    joined = {
        f"models_{name}": np.concatenate([each[name] for each in made])
        for name in ("visits", "reward_sums", "successor_states", "successor_counts")
    }
    return {
        "q": np.zeros((STATES, ACTIONS)),
        "models_successor_offsets": np.concatenate([*offsets, starts[-1:]]),
        **joined,
        "switches": np.array(switches, np.int64).reshape(-1, 4),
        "active": np.array([active]),
    }


def cell_of(experiment):
    return next(cell for cell in plan(load_text(CONFIG, "several.yaml")) if cell.experiment == experiment)


@pytest.fixture(scope="module")
def found():
    return of_saved(cell_of("visit"), saved_of())


def test_a_model_is_whose_steps_it_counts_after_they_changed_hands(found):
    keen, shy = found.models
    assert [(each.number, each.human) for each in found.models] == [(0, "keen"), (1, "shy")]
    assert keen.steps == {"keen": 900 + 1000, "shy": 0}  # from step 2,000 on again
    assert shy.steps == {"keen": 100, "shy": 1000}
    assert keen.trained == 4000 - 1900


def test_beliefs_are_where_the_distance_is_right_beside_the_truth_of_that_human(found):
    keen, shy = found.models
    come = keen.beliefs[COME]
    assert (come.visits, come.probability, come.true) == (2000, 1.0, 1.0)
    assert come.low == pytest.approx(2000 / (2000 + 2.576**2))  # Wilson's, of all
    assert come.high == pytest.approx(1.0)
    assert (shy.beliefs[COME].probability, shy.beliefs[COME].true) == (0.0, 0.0)
    assert (shy.beliefs[LOST].probability, shy.beliefs[LOST].true) == (0.25, 0.25)
    assert keen.beliefs[LOST].true == 0.0
    assert math.isnan(shy.beliefs[COMPARED[0]].probability)
    assert keen.graph.visits.sum() == 4000  # and the graph has all


def test_all_as_one_have_each_a_say(found):
    """2,000 that follow and 400 that do not count as 100 each."""
    assert found.shared[COME].probability == pytest.approx(0.5)
    assert found.shared[COME].visits == 200
    assert math.isnan(found.shared[COME].true)


def test_of_a_pool_nobody_is_the_owner():
    several = of_saved(cell_of("from_both"), saved_of(models=SEEN[:1], switches=[]))
    assert [(each.human, each.steps, each.trained) for each in several.models] == [("shy", {"shy": 3000}, 1000)]
    many = {**SEEN[0], (3, NEAR, Action.STAY, 3): 6000}
    (model,) = of_saved(cell_of("from_both"), saved_of(models=(many,), switches=[])).models
    assert (model.human, model.trained) == ("", 7000)
    assert math.isnan(model.beliefs[COME].true)


@pytest.mark.parametrize(("of_shy", "whose", "true"), [(899, "keen", 1.0), (900, "", math.nan), (901, "shy", 0.0)])
def test_a_model_is_somebodys_with_more_than_half_of_its_steps_and_else_several_humans(of_shy, whose, true):
    """It counts 900 steps with keen, none of training, and some with shy, who comes after 1,000."""
    seen = {(5, NEAR, Action.COME, 7): 900 + of_shy}, {(3, NEAR, Action.LOOK, 3): 3000}
    switches = [[1000, 0, 1, 900], [1000, 1, 0, 1000], [1000 + of_shy, 0, 1, 1000 + of_shy]]
    found = of_saved(cell_of("visit"), saved_of(models=seen, switches=switches, active=1))
    model = found.models[0]
    assert (model.steps, model.trained) == ({"keen": 900, "shy": of_shy}, 0)
    assert model.human == whose
    assert model.beliefs[COME].true == pytest.approx(true, nan_ok=True)
    assert as_json(found)["models"][0]["human"] == (whose or None)
    (line,) = (line for line in models_text(found).splitlines() if line.startswith("model 0"))
    assert line.split()[2] == (whose or "several")


def believed(*shares, visits=1000):
    return [Belief(visits, share, max(0, share - 0.02), min(1, share + 0.02), math.nan) for share in shares]


@pytest.mark.parametrize(
    ("beliefs", "said"),
    [
        (believed(0.9, 0.92, 0.89), Verdict.GENERAL),
        (believed(0.9, 0.5), Verdict.DEGREE),
        (believed(0.9, 0.0), Verdict.SPECIFIC),
        (believed(0.01, 0.02), Verdict.NONE),
        (believed(0.05, 0.06), Verdict.OPEN),
        (believed(0.9), Verdict.OPEN),
        (believed(0.9) + believed(0.0, visits=9), Verdict.OPEN),
        ([*believed(0.9, 0.9), Belief(0, math.nan, 0, 1, math.nan)], Verdict.GENERAL),
    ],
)
def test_what_an_arrow_is(beliefs, said):
    assert verdict(beliefs) is said


def test_as_json_has_each_model_and_each_arrow(found):
    told = as_json(found)
    assert [(each["model"], each["human"]) for each in told["models"]] == [(0, "keen"), (1, "shy")]
    assert sum(line["visits"] for line in told["models"][1]["transitions"]) == 1100
    by_arrow = {(each["action"], each["level_next"]): each for each in told["affordances"]}
    assert by_arrow["come", "FOLLOWS"]["verdict"] == "specific"
    assert by_arrow["come", "FOLLOWS"]["models"][1] == {
        "visits": 400,
        "learned": 0.0,
        "interval": [0.0, pytest.approx(2.576**2 / (400 + 2.576**2))],
        "true": 0.0,
    }
    assert by_arrow["look", "ROBOT_FACES"]["models"][1]["learned"] is None


def test_what_is_drawn_is_what_was_found(found):
    with styled(STYLE):
        figure = draw_several(found)
    whose, general, first, second, lines = figure.axes
    assert {text.get_text() for text in whose.texts} == {"2,100", "1,900", "100", "1,000", "-"}
    assert "come 0.500" in " ".join(text.get_text() for text in general.texts)
    assert [axes.get_title("left") for axes in (first, second)] == ["Model 0: keen", "Model 1: shy"]
    for axes, model in ((first, found.models[0]), (second, found.models[1])):
        (said,) = (text.get_text() for text in axes.texts if text.get_gid() == "come/5/7")
        assert float(said) == pytest.approx(model.beliefs[COME].probability, abs=0.005)
    assert [text.get_text() for text in lines.texts] == [str(found.verdicts[arrow]) for arrow in COMPARED]
    drawn = {(line.get_gid(), float(line.get_xdata()[0])) for line in lines.lines if line.get_gid()}
    assert drawn == {
        (f"{model.number}/{COMPARED.index(arrow)}", belief.probability)
        for model in found.models
        for arrow, belief in model.beliefs.items()
        if belief.visits
    }


@pytest.mark.parametrize("lost", [Verdict.NONE, Verdict.DEGREE])
def test_coloured_is_what_is_said_to_differ_and_what_is_not_compared_is_told(found, lost):
    """One of each verdict in turn; of the four ways of losing attention, one arrow in the graphs, the last decides."""
    several = [arrow for arrow in COMPARED if arrow.outcome < len(InteractionLevel)]
    verdicts = dict.fromkeys(COMPARED, Verdict.NONE) | dict(zip(several, [*Verdict, *Verdict], strict=False))
    verdicts[COMPARED[-1]] = lost
    with styled(STYLE):
        figure = draw_several(found._replace(verdicts=verdicts))
    *_, first, second, lines = figure.axes
    differs = {Verdict.DEGREE, Verdict.SPECIFIC}
    for axes in (first, second):
        drawn = {patch.get_gid(): to_hex(patch.get_edgecolor()) for patch in axes.patches if patch.get_gid()}
        grey = to_hex(PALE)
        assert {name for name, colour in drawn.items() if colour != grey} == {
            *(f"{arrow.kind}/{int(arrow.level)}/{arrow.outcome}" for arrow in several if verdicts[arrow] in differs),
            *(["loss"] if lost in differs else []),
        }
        assert drawn["go_to_human_vision/0/2"] == grey
    assert {text.get_text() for text in lines.texts if text.get_color() == INK} <= set(differs)
    assert {text.get_text() for text in lines.texts if text.get_color() == GREY}.isdisjoint(differs)
    assert "go to view, which teleports in training" in " ".join(text.get_text() for text in figure.texts)
    assert "Not compared:\ngo_to_human_vision, which teleports" in models_text(found)


@pytest.mark.parametrize("humans", [1, 2, 6])
def test_a_models_marker_covers_nothing_of_its_name(found, humans):
    steps = {f"human {number}": 100 for number in range(humans)}
    models = [found.models[0]._replace(number=number, steps=steps) for number in (3, 10)]
    with styled(STYLE):
        figure = draw_several(found._replace(models=models))
        figure.canvas.draw()
        whose = figure.axes[0]
        for label, marker in zip(whose.get_yticklabels(), whose.lines, strict=True):
            assert label.get_window_extent().x1 < marker.get_window_extent().x0
            assert marker.get_window_extent().x1 < whose.get_window_extent().x0


def test_the_graphs_count_as_the_beliefs_do(found):
    for compared, beliefs in [
        (found.compared, found.shared),
        *((model.compared, model.beliefs) for model in found.models),
    ]:
        for arrow, belief in beliefs.items():
            assert weight(compared, arrow).visits == belief.visits
    assert found.models[0].compared.visits.sum() < found.models[0].graph.visits.sum() == 4000


def test_names_are_whole_and_free_with_as_many_models_as_there_may_be(found):
    name = "W" * 64
    one = found.models[0]._replace(human=name, steps={name: 1_000_000, **{f"{name[:-1]}{n}": 0 for n in range(5)}})
    several = found._replace(models=[one._replace(number=number) for number in range(8)])
    with styled(STYLE):
        figure = draw_several(several)
    words = words_of(figure)
    assert beyond(figure, words) == []
    assert upon_another(words) == []


def test_the_same_bytes_and_no_other_ending(found, tmp_path):
    files = [tmp_path / f"{name}.svg" for name in "ab"]
    for file in files:
        save_several(found, file)
    assert files[0].read_bytes() == files[1].read_bytes()
    with pytest.raises(UsageError, match=r"must end in \.svg, \.png, \.pdf"):
        save_several(found, tmp_path / "picture.gif")
