"""Captions and moments of steps written by hand."""

import numpy as np
import pytest

from visitlab_cli.scene.moments import Moment, facts, left_out, moments, strip_steps
from visitlab_cli.scene.words import caption, captions
from visitlab_cli.world.enums import Action, Direction, InteractionLevel
from visitlab_cli.world.lab import paper_lab

LEVEL = InteractionLevel


def visit(*rows):
    """The columns of a visit from rows that say only what differs from two who stand still."""
    still = {
        "action": Action.STAY,
        "explored": False,
        "reward": 0,
        "robot_row": 5,
        "robot_col": 5,
        "human_row": 8,
        "human_col": 5,
        "human_action": Action.STAY,
        "interaction_level": LEVEL.NOT_SEEN,
        "distance": 2,
        "desired_direction": Direction.SOUTH_WEST,
        "goal_room": 4,
    }
    filled, last = [], still
    for row in rows:
        last = {**last, "action": Action.STAY, "human_action": Action.STAY, "reward": 0, **row}
        filled.append({"executed_action": last["action"], **last})
    columns = {name: np.array([row[name] for row in filled]) for name in filled[0]}
    return {"step": np.arange(len(rows)), **columns}


BEGIN = {"action": Action.NO_ACTION, "human_action": Action.NO_ACTION}


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        (
            {"interaction_level": LEVEL.BOTH_FACE},
            {"action": Action.HELLO, "interaction_level": LEVEL.GREETED},
            "says hello; the human faces it and now follows it with its gaze",
        ),
        (
            {"interaction_level": LEVEL.ROBOT_FACES},
            {"action": Action.HELLO},
            "says hello; the human does not react: it sees it turned to the human",
        ),
        (
            {"interaction_level": LEVEL.GREETED},
            {"action": Action.COME, "interaction_level": LEVEL.FOLLOWS},
            "says come; the human now follows it",
        ),
        (
            {"interaction_level": LEVEL.GREETED},
            {"action": Action.COME, "interaction_level": LEVEL.CALLED},
            "says come; the human now waits to be shown the way",
        ),
        (
            {"interaction_level": LEVEL.CALLED},
            {"action": Action.POINT, "interaction_level": LEVEL.FOLLOWS, "desired_direction": Direction.EAST},
            "points south-west; the human now follows it",
        ),
        (
            {"interaction_level": LEVEL.FOLLOWS},
            {"action": Action.MOVE_3_NORTH, "robot_row": 2, "human_action": Action.MOVE_2_NORTH, "human_row": 6},
            "moves 3 cells north; the human follows 2 cells north",
        ),
        (
            {"interaction_level": LEVEL.FOLLOWS, "robot_row": 1},
            {"action": Action.MOVE_3_NORTH, "robot_row": 0, "human_action": Action.MOVE_2_NORTH, "human_row": 6},
            "moves 1 cell north, then is blocked; the human follows 2 cells north",
        ),
        (
            {"interaction_level": LEVEL.FOLLOWS, "distance": 0},
            {"interaction_level": LEVEL.HUMAN_FACES},
            "stays; the human loses attention, too close, but still faces it",
        ),
        (
            {"interaction_level": LEVEL.FOLLOWS, "distance": 0},
            {"interaction_level": LEVEL.SEEN, "human_action": Action.MOVE_2_NORTH, "human_row": 6},
            "stays; the human loses attention, too close, wanders 2 cells north, but still sees it",
        ),
        (
            {"interaction_level": LEVEL.GREETED},
            {"interaction_level": LEVEL.NOT_SEEN},
            "stays; the human loses attention and no longer sees it",
        ),
        (
            {"interaction_level": LEVEL.HUMAN_FACES},
            {"action": Action.LOOK, "interaction_level": LEVEL.BOTH_FACE},
            "looks at the human; the human is face to face with it",
        ),
        (
            {},
            {
                "action": Action.GO_TO_HUMAN_VISION,
                "executed_action": Action.MOVE_1_EAST,
                "robot_col": 6,
                "interaction_level": LEVEL.SEEN,
            },
            "goes to the human's view: moves 1 cell east; the human now sees it",
        ),
        (
            {},
            {"human_action": Action.MOVE_2_EAST, "human_col": 7},
            "stays; the human wanders 2 cells east and does not see it",
        ),
        (
            {"interaction_level": LEVEL.FOLLOWS},
            {"action": Action.HELLO, "reward": 1, "goal_room": 7},
            "says hello; the human waits; goal reached in Room 4, the next is Room 7",
        ),
    ],
)
def test_caption(before, after, words):
    assert caption(visit({**BEGIN, **before}, after), 1, paper_lab()) == words


def test_moments_and_facts():
    levels = [0, 0, 1, 4, 5, 5, 7, 7, 7, 2, 4, 5]
    rewarded = {7, 8}
    steps = visit(*({"interaction_level": level, "reward": int(step in rewarded)} for step, level in enumerate(levels)))
    assert moments(steps, paper_lab()) == [
        Moment(2, "seen"),
        Moment(4, "greeted"),
        Moment(6, "following"),
        Moment(7, "goal reached"),
        Moment(8, "goal reached"),
        Moment(9, "attention lost"),
        Moment(11, "greeted"),
    ]
    assert facts(steps, paper_lab()) == {
        "seen": 2,
        "greeted": 4,
        "following": 6,
        "goal reached": 7,
        "attention lost": 9,
    }
    assert strip_steps(steps, paper_lab()) == [0, 2, 4, 6, 7, 8, 9, 11]


def test_what_a_strip_leaves_out():
    steps = visit(*({"interaction_level": LEVEL.FOLLOWS, "reward": int(step > 0)} for step in range(16)))
    shown = strip_steps(steps, paper_lab())
    assert shown == list(range(12))
    assert left_out(steps, shown, paper_lab()) == "4 more steps with a moment, up to step 15"
    assert left_out(steps, range(15), paper_lab()) == "1 more step with a moment, up to step 15"
    assert left_out(steps, range(16), paper_lab()) == ""


@pytest.mark.parametrize(
    ("row", "col", "words", "kind"),
    [
        (8, 8, "the human began in goal Room 4, the next is Room 7", "began in the goal room"),
        (15, 15, "the human began in goal Room 4, the next is Room 7", "began in the goal room"),
        (7, 8, "goal reached in Room 4, the next is Room 7", "goal reached"),
        (8, 16, "goal reached in Room 4, the next is Room 7", "goal reached"),
    ],
)
def test_a_goal_that_the_human_stood_in_from_the_start_is_none_that_it_was_led_to(row, col, words, kind):
    steps = visit({**BEGIN, "human_row": row, "human_col": col}, {"reward": 1, "goal_room": 7}, {"reward": 1})
    assert caption(steps, 1, paper_lab()).endswith(f"; {words}")
    assert [moment for moment in moments(steps, paper_lab()) if moment.step == 1] == [Moment(1, kind)]
    assert moments(steps, paper_lab())[-1] == Moment(2, "goal reached")
    assert facts(steps, paper_lab())["goal reached"] == (2 if "began" in kind else 1)


@pytest.mark.parametrize(("row", "began"), [(9, True), (7, False)])
def test_a_robot_that_began_in_the_goal_room_did_not_reach_it(row, began):
    rows = [{"robot_row": at, "robot_col": 9, "reward": reward} for at, reward in ((row, 0), (8, 1), (8, 1))]
    whole = visit(*rows)
    columns = ("step", "action", "explored", "reward", "robot_row", "robot_col", "goal_room")
    steps = {name: whole[name] for name in columns}
    assert caption(steps, 1, paper_lab()).endswith(
        "rewarded: in Room 4, where it began" if began else "rewarded: in Room 4"
    )
    assert caption(steps, 2, paper_lab()).endswith("rewarded: in Room 4")
    assert moments(steps, paper_lab()) == [Moment(1, "began in the goal room" if began else "goal reached")]


@pytest.mark.parametrize("task", ["navigation", "go_to_human", "social", "visit"])
def test_every_recorded_step_has_a_caption(trial_of, task):
    trial = trial_of(task)
    told = captions(trial.steps, paper_lab())
    assert len(told) == trial.last_step + 1
    assert told[0].startswith("the trial begins")
    assert [("reward" in words or "goal" in words) for words in told[1:]] == [
        reward > 0 for reward in trial.steps["reward"][1:]
    ]


def test_of_several_models_the_first_and_each_change_are_told():
    steps = visit(BEGIN, {}, {"action": Action.LOOK}, {}) | {"active_model": np.array([1, 1, 3, 3])}
    told = captions(steps, paper_lab())
    assert told[0] == "the trial begins, with model 1; the human does not see it"
    assert told[2] == "looks at the human; the human does not see it; the robot changes to model 3"
    assert [words.count("model") for words in told] == [1, 0, 1, 0]
