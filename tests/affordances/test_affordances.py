"""Learned affordances: the true Fig. 4 against frequencies in logs, counts against logs, the map against symmetry."""

import math

import numpy as np
import pytest

from tests.oracle.tally import z_score
from tests.world.package_log import HUMAN, package_log
from visitlab_cli.affordances.counts import KINDS, Kind, count_levels, kind_of, learned_counts
from visitlab_cli.affordances.learned import affordances, graph
from visitlab_cli.affordances.plain import ARROWS, as_json, weight
from visitlab_cli.affordances.policy import UNSEEN, policy_map
from visitlab_cli.affordances.truth import FIRST_ENGAGED, true_transitions
from visitlab_cli.errors import NotFoundError
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.log.reader import read_steps
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.selection import Selection
from visitlab_cli.storage.arrays import read_model
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.enums import Action, InteractionLevel
from visitlab_cli.world.scene import NOWHERE
from visitlab_cli.world.social import parts_of, social_state

STEPS = 120_000
SURPRISE = 4.5


def counts_in(log):
    """The transitions of a log as learned counts have them."""
    taken = np.flatnonzero(log["step"] > 0)
    return count_levels(log["state"][taken - 1], log["action"][taken], log["state"][taken])


@pytest.fixture(scope="module")
def logged():
    return {task: counts_in(package_log(task, STEPS, seed=5)) for task in ("social", "visit")}


def surprises(counts, truth):
    """Every (kind, level, outcome) whose frequency lies outside what the truth allows, and how many were looked at."""
    at_distance = counts.sum(axis=3)
    outcomes = counts.sum(axis=2)
    outcomes = np.concatenate([outcomes, outcomes[..., :FIRST_ENGAGED].sum(axis=-1, keepdims=True)], axis=-1)
    found, looked_at = [], 0
    for place in np.ndindex(outcomes.shape):
        kind, level, outcome = place
        n = at_distance[kind, level]
        low, high = (bound[kind, level, :, outcome][n > 0] for bound in truth)
        n = n[n > 0]
        if n.sum() == 0 or np.isnan(low).any():
            continue
        looked_at += 1
        observed, total = int(outcomes[place]), int(n.sum())
        too_many = z_score(observed, float(n @ high), float(n @ (high * (1 - high))), total)
        too_few = z_score(observed, float(n @ low), float(n @ (low * (1 - low))), total)
        if too_many > SURPRISE or too_few < -SURPRISE:
            found.append((KINDS[kind], InteractionLevel(level).name, outcome, observed, total))
    return found, looked_at


@pytest.mark.parametrize("task", ["social", "visit"])
def test_the_true_transitions_are_the_frequencies_in_a_log(logged, task):
    found, looked_at = surprises(logged[task], true_transitions(SixParameters(**HUMAN), task == "social"))
    assert looked_at > 200
    assert found == []


MUTATED = [("p_H", 0.5), ("p_A", 0.2), ("p_P", 0.6), ("p_M", 0.6), ("p_O", 0.5)]


@pytest.mark.parametrize(("parameter", "value"), MUTATED)
def test_another_human_would_be_noticed(logged, parameter, value):
    assert surprises(logged["social"], true_transitions(SixParameters(**HUMAN | {parameter: value}), True))[0]


def test_the_arrows_of_a_human_that_never_fails():
    truth = true_transitions(SixParameters(p_S=(1, 0, 0)), True)
    near, far = 2, 4
    for kind, level, outcome, probability in [
        (Kind.HELLO, InteractionLevel.SEEN, InteractionLevel.GREETED, 0),
        (Kind.HELLO, InteractionLevel.ROBOT_FACES, InteractionLevel.GREETED, 1),
        (Kind.COME, InteractionLevel.GREETED, InteractionLevel.FOLLOWS, 1),
        (Kind.POINT, InteractionLevel.CALLED, InteractionLevel.FOLLOWS, 1),
        (Kind.AWAY, InteractionLevel.FOLLOWS, InteractionLevel.FOLLOWS, 1),
    ]:
        place = KINDS.index(kind), level
        assert truth.low[(*place, near, outcome)] == truth.high[(*place, near, outcome)] == probability
        assert truth.high[(*place, far, outcome)] == 0
    vision = KINDS.index(Kind.GO_TO_HUMAN_VISION), 0, near
    # it lands straight ahead of the human; three of its eight headings face the human
    assert truth.low[(*vision, InteractionLevel.BOTH_FACE)] == pytest.approx(3 / 8)
    assert truth.high[(*vision, InteractionLevel.HUMAN_FACES)] == pytest.approx(5 / 8)


def test_states_are_taken_apart_as_the_world_puts_them_together():
    for level, distance, desired, angle in [(7, 4, 7, 7), (3, 0, 5, 1), (0, 2, 0, 6)]:
        scene = NOWHERE._replace(perceived_level=level, distance=distance, desired_direction=desired, angle=angle)
        assert tuple(map(int, parts_of(social_state(scene)))) == (level, distance, desired, angle)


def test_moves_are_told_by_their_direction_to_the_human():
    moves = [
        Action.MOVE_1_EAST,
        Action.MOVE_2_NORTH_EAST,
        Action.MOVE_3_NORTH,
        Action.MOVE_1_NORTH_WEST,
        Action.MOVE_2_WEST,
    ]
    names = [KINDS[index] for index in kind_of(moves, 0)]
    assert names == [Kind.TOWARDS, Kind.TOWARDS, Kind.SIDEWAYS, Kind.AWAY, Kind.AWAY]
    rest = [KINDS[index] for index in kind_of(range(Action.STAY, Action.GO_TO_HUMAN_VISION + 1), 3)]
    assert rest == [Kind.STAY, Kind.LOOK, Kind.HELLO, Kind.COME, Kind.POINT, Kind.GO_TO_HUMAN_VISION]


def test_a_model_counts_what_its_log_shows(tiny_run):
    cell = tiny_run / "social" / "mb" / "fast" / "seed-0000"
    log = read_steps(cell / "steps.mcap")
    assert (learned_counts(read_model(cell / "model.npz")) == counts_in(log)).all()


def test_a_visit_saw_what_its_log_shows(tiny_run):
    found = affordances(tiny_run, plan(read_config(tiny_run)))
    assert found.cell.path == "social/mb/fast/seed-0000"
    assert [each.cell.path for each in found.adaptations] == ["visit/fast/seed-0000", "visit/slow/seed-0000"]
    for each in found.adaptations:
        seen = counts_in(read_steps(tiny_run / each.cell.path / "steps.mcap"))
        assert (each.saw.visits == seen.sum(axis=(2, 3))).all()
        assert (each.knows.visits == found.knows.visits + each.saw.visits).all()


def test_learned_shares_are_those_of_the_counts():
    counts = np.zeros((len(KINDS), 8, 5, 8), np.int64)
    come, greeted = KINDS.index(Kind.COME), InteractionLevel.GREETED
    counts[come, greeted, 2, InteractionLevel.FOLLOWS] = 6
    counts[come, greeted, 4, InteractionLevel.SEEN] = 2  # too far: attention lost for sure
    human = SixParameters(p_S=(1, 0, 0), p_P=0.5)
    made = graph(counts, true_transitions(human, True))
    followed = weight(
        made, next(each for each in ARROWS if each.outcome == InteractionLevel.FOLLOWS and each.level == greeted)
    )
    assert followed.visits == 8
    assert followed.learned == 0.75
    assert followed.low == followed.high == pytest.approx(0.5 * 6 / 8)
    assert made.learned[come, greeted, -1] == 0.25
    assert math.isnan(made.learned[0, 0, 0])


def test_the_map_turns_the_desired_directions_onto_one_another():
    states = parts_of(np.arange(2560))
    q, visits = np.zeros((2560, 30)), np.zeros((2560, 30), int)
    ahead = (states.angle + 4 - states.desired_direction) % 8 == 0
    fast = Action.MOVE_3_EAST + (states.desired_direction + 1) % 8  # 45 degrees left of the desired direction
    q[np.arange(2560), np.where(ahead, fast, Action.COME)] = 2.0
    visits[states.level == InteractionLevel.FOLLOWS] = 1
    made = policy_map(q, visits)
    assert (made.action[InteractionLevel.FOLLOWS, :, 0] == Action.MOVE_3_NORTH_EAST).all()
    assert (made.action[InteractionLevel.FOLLOWS, :, 1:] == Action.COME).all()
    assert (made.share[InteractionLevel.FOLLOWS] == 1).all()
    assert (made.visits[InteractionLevel.FOLLOWS] == 8 * 30).all()
    assert (made.value[InteractionLevel.FOLLOWS] == 2).all()
    assert (made.action[: InteractionLevel.FOLLOWS] == UNSEEN).all()


def test_as_json_tells_every_action_and_level(tiny_run):
    found = as_json(affordances(tiny_run, plan(read_config(tiny_run)), Selection(agent="rmax")))
    assert found["trained"]["cell"] == "social/rmax/fast/seed-0000"
    lines = found["trained"]["transitions"]
    assert len(lines) == len(KINDS) * 8
    for line in lines:
        if line["visits"]:
            assert sum(line["learned"][level.name] for level in InteractionLevel) == pytest.approx(1)
            bounds = [line["true"][name] for name in ("GREETED", "CALLED", "FOLLOWS", "NOT_ENGAGED")]
            assert sum(low for low, _ in bounds) <= 1 + 1e-9 <= sum(high for _, high in bounds) + 2e-9


def test_a_module_without_a_model_is_not_found(tiny_run):
    with pytest.raises(NotFoundError, match="there are social/mb/fast, social/rmax/fast"):
        affordances(tiny_run, plan(read_config(tiny_run)), Selection(agent="mf"))
