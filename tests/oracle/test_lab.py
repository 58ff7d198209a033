"""The oracle's labs worked out by hand, and its own games in them: the right ones pass, wrong ones are told."""

import random
from pathlib import Path

import numpy as np
import pytest

from visitlab_cli.world.enums import Engagement

from . import rules
from .checker import check_frequencies, check_log
from .lab import Lab
from .playing import Game, play
from .settings import Settings
from .sight import borders_met
from .test_checker import HUMAN, LIMIT

E, NE, N, NW, W, SW, S, SE = range(8)
NINE = (Path(__file__).parent / "nine_rooms.txt").read_text()
SMALL = Lab("AAAAA AAaAA BBbBB BBBBB")  # a doorway of one cell between two rooms
FOUR = "AAabBB AAABBB AaABbB CcCDdD CCCDDD CCcdDD"  # four rooms in a ring
TRIALS = {"navigation": 150, "go_to_human": 150, "visit": 60}


# ---------------------------------------------------------------------------------------------- the map


def test_doors_are_named_by_their_rooms_and_hold_every_open_border():
    lab = Lab(NINE)
    assert sorted(lab.doors) == ["AB", "AD", "BC", "BE", "CF", "DE", "DG", "EF", "EH", "FI", "GH", "HI"]
    assert lab.doors["BE"] == {frozenset({(7, col), (8, col)}) for col in (11, 12)}
    assert SMALL.doors == {"AB": {frozenset({(1, 2), (2, 2)})}}


def test_walls_stand_between_rooms_but_in_doorways():
    grid = SMALL.grid(-1)
    assert len(grid.walls) == 4
    assert grid.move((0, 2), 3, S) == (3, 2)
    assert grid.move((0, 1), 3, S) == (1, 1)
    assert grid.move((1, 2), 1, SE) == grid.move((1, 2), 1, SW) == (1, 2)
    assert [grid.room(cell) for cell in ((1, 2), (2, 2))] == [0, 1]


def test_nobody_enters_a_solid_cell_or_passes_its_corner():
    grid = Lab("AAA A#A AAA").grid(-1)
    assert grid.move((0, 1), 1, S) == (0, 1)
    assert grid.move((0, 1), 1, SE) == (0, 1)
    assert grid.move((0, 0), 3, E) == (0, 2)
    assert grid.n_rooms == 1
    assert not grid.sees((0, 1), (2, 1))
    assert not grid.sees((0, 1), (1, 2))
    assert grid.sees((0, 0), (0, 2))


def test_a_closed_door_is_a_wall_for_good_and_a_toggling_one_while_it_is_shut():
    assert Lab(SMALL.map, closed=["AB"]).grid(-1).move((1, 2), 1, S) == (1, 2)
    lab = Lab(NINE, closed=["DE"], toggling={"DE": 0.1, "BE": 0.2})
    assert lab.toggled == ["BE", "DE"]
    assert lab.open_at_first == 0b01
    for open_doors in range(4):
        assert (lab.grid(open_doors).move((7, 11), 1, S) == (8, 11)) == bool(open_doors & 1)
        assert (lab.grid(open_doors).move((11, 7), 1, E) == (11, 8)) == bool(open_doors & 2)


def test_starts_and_goals_are_what_is_reached_while_every_toggling_door_is_shut():
    assert Lab("AabB AACC AACC").goals == {0, 1}
    assert len(Lab("AabB AACC AACC").starts) == 8
    toggling = Lab("AabB AACC AACC", toggling={"AB": 0.1})
    assert toggling.goals == {0}
    assert toggling.starts == ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1))
    assert Lab("AabB AACC AACC", corridor="B").goals == {0}
    assert Lab("AA#B AA#B AA#B").starts == tuple((row, col) for row in range(3) for col in (0, 1))


# ------------------------------------------------------------------------------------------------ sight


def test_the_borders_that_a_line_meets():
    assert set(borders_met(0, 2)) == {((0, 0), (0, 1)), ((0, 1), (0, 2))}
    assert set(borders_met(-1, 2)) == {((0, 0), (0, 1)), ((-1, 1), (0, 1)), ((-1, 1), (-1, 2))}
    corner = {((0, 0), (0, 1)), ((0, 1), (1, 1)), ((1, 1), (1, 0)), ((1, 0), (0, 0))}
    assert {frozenset(border) for border in borders_met(1, 1)} == {frozenset(border) for border in corner}
    # Three down and one right: the middle row of four is left halfway along its side.
    assert set(borders_met(2, 1)) == {((0, 0), (1, 0)), ((1, 0), (1, 1)), ((1, 1), (2, 1))}
    assert borders_met(0, 0) == ()


def test_sight_ends_at_a_wall_at_its_end_and_beside_a_doorway():
    grid = SMALL.grid(-1)
    assert grid.sees((0, 2), (3, 2))
    assert not grid.sees((1, 1), (2, 1))
    assert not grid.sees((1, 1), (2, 2)), "the line meets the end of the wall, at the doorway's corner"
    assert grid.sees((1, 2), (3, 3)), "it leaves the doorway a quarter of a cell beside the wall's end"
    assert not grid.sees((0, 2), (3, 3)), "it meets that end"
    assert not grid.sees((0, 1), (3, 2)), "and that of the other side"
    assert grid.sees((1, 1), (1, 4))


# ------------------------------------------------------------------------------------- who is out of sight


def test_out_of_sight_nobody_is_seen_greeted_or_kept():
    grid = Lab("AAAbBBB AAABBBB").grid(-1)  # no doorway: only one of its cells is in lower case
    robot, human, sure = (1, 1), (1, 4), rules.Human((1.0, 0.0, 0.0), 0.0, 0.0, 0.0, 0.0, 0.0)
    geo = rules.geometry_in(grid, robot, E, human, W)
    assert geo == (4, E, False, False, False)
    assert rules.interaction_level(geo) == 0
    assert rules.interaction_level(geo, Engagement.FOLLOWING) == 7
    assert rules.go_to_human_reward(geo) == rules.go_to_human_reward(geo, "seen") == 0
    for engagement in Engagement:
        for action in (24, 26, 27, 28):
            outcomes = rules.human_step(grid, robot, E, human, W, engagement, action, sure)
            assert outcomes == {rules.Outcome(Engagement.NONE, 24, human, W): 1.0}


# ---------------------------------------------------------------------------------------------- its games

LABS = {
    "nine rooms": {"lab": Lab(NINE)},
    "corridor": {"lab": Lab("AAABBB AaABbB ZzZZzZ ZZZZZZ ZzZZZZ CcC#DD CCC#DD", corridor="Z")},  # no way leads to D
    "doors": {"lab": Lab(FOUR, closed=["AC"], toggling={"AB": 0.4, "AC": 0.2})},
}


def settings_of(task, lab):
    return LABS[lab] | ({"human": HUMAN} if task == "visit" else {})


def worst(log, task, **settings):
    return max(abs(frequency.z) for frequency in check_frequencies(log, task, **settings))


@pytest.mark.parametrize("lab", LABS)
@pytest.mark.parametrize("task", TRIALS)
def test_a_right_log_passes(task, lab):
    settings = settings_of(task, lab)
    log = play(task, TRIALS[task], seed=3, **settings)
    assert check_log(log, task, **settings) == []
    assert worst(log, task, epsilon=0.5, **settings) < LIMIT


def test_phases_have_labs_and_doors_of_their_own():
    doors = LABS["doors"]["lab"]
    shut = Lab(doors.map, closed=["AB", "AC"])
    phases = [(20, HUMAN, shut), (30, HUMAN, doors), (20, HUMAN, Lab(doors.map)), (30, HUMAN, doors)]
    log = play("visit", 100, seed=5, phases=phases, trial_steps=30)
    assert set(log["open_doors"][np.isin(log["phase"], (0, 2))]) == {-1}
    assert check_log(log, "visit", phases=phases, trial_steps=30) == []
    assert worst(log, "visit", phases=phases, trial_steps=30) < LIMIT
    kept = log["trial"] % 3 == 0
    some = {name: values[kept] for name, values in log.items()}
    assert check_log(some, "visit", phases=phases, trial_steps=30, trial_stride=3) == []
    assert worst(some, "visit", phases=phases, trial_steps=30, trial_stride=3) < LIMIT
    log["goal_room"] = np.where(log["phase"] == 0, 0, log["goal_room"])  # room A is shut off in phase 0
    found = check_log(log, "visit", phases=phases, trial_steps=30)
    assert (0, "goal_room") in {(each.row, each.column) for each in found}


@pytest.mark.parametrize("other", [{"AB": 0.2, "AC": 0.2}, {"AB": 0.4, "AC": 0.0}, {"AB": 1.0, "AC": 0.2}])
def test_other_toggling_is_told(other):
    right = LABS["doors"]["lab"]
    log = play("go_to_human", 200, seed=6, lab=Lab(right.map, closed=["AC"], toggling=other), trial_steps=1)
    for lab, accepted in ((Lab(right.map, closed=["AC"], toggling=other), True), (right, False)):
        found = check_log(log, "go_to_human", lab=lab, trial_steps=1)
        assert (found == [] and worst(log, "go_to_human", lab=lab, trial_steps=1) < LIMIT) == accepted


def test_a_wrong_door_is_seen_where_it_stands():
    settings = settings_of("navigation", "doors")
    log = play("navigation", 20, seed=7, **settings)
    for row in (5, 10, 30, 205):
        wrong = log | {"open_doors": log["open_doors"].copy()}
        wrong["open_doors"][row] ^= 1
        found = check_log(wrong, "navigation", **settings)
        assert {each.row for each in found if each.column == "open_doors"} == {row, row + 1}


class TogglesInTheMiddle(Game):
    def step(self):
        if self.row["step"] == 10:
            self.row["open_doors"] = self.toggled(self.row["trial"], self.row)
            self.place = self.settings.place(self.row["trial"], self.row["open_doors"])
        super().step()


class StartsAnywhere(Game):
    def put(self, who, cell, heading):
        if self.row["step"] == 0:
            cell = self.random.choice(list(self.grid.cells()))
        super().put(who, cell, heading)


class TogglesTogether(Game):
    def toggled(self, trial, last):
        self.random = random.Random(trial)
        chosen = super().toggled(trial, last)
        now = last["open_doors"] if last else 1
        return now ^ 3 if (chosen ^ now) & 2 else now ^ (self.random.random() < 0.25)


@pytest.mark.parametrize(
    ("game", "task", "lab"),
    [
        (TogglesInTheMiddle, "navigation", "doors"),
        (TogglesTogether, "navigation", "doors"),
        (StartsAnywhere, "visit", "corridor"),
    ],
)
def test_a_log_of_another_game_is_refused(game, task, lab):
    settings = settings_of(task, lab)
    log = game(Settings(task=task, **settings), random.Random(7)).play(TRIALS[task])
    assert check_log(log, task, **settings) or worst(log, task, **settings) > LIMIT


@pytest.mark.parametrize("task", ["go_to_human", "visit"])
@pytest.mark.parametrize(
    ("attribute", "wrong"),
    [
        ("geometry_in", lambda grid, *scene: rules.geometry(*scene)),
        ("TOO_FAR", 3),
    ],
    ids=["sees through walls", "out of sight is wide"],
)
def test_a_log_of_wrong_rules_is_refused(task, attribute, wrong, monkeypatch):
    settings = settings_of(task, "nine rooms")
    with monkeypatch.context() as patched:
        patched.setattr(rules, attribute, wrong)
        log = play(task, TRIALS[task], seed=6, **settings)
    assert check_log(log, task, **settings)
