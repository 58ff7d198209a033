"""Who decides in a visit: the paper's modules by themselves (Fig. 5), or with what navigation knows of moving.

A controller is a record of a visit, with an operation for each moment at which it may do otherwise than the paper:
a trial's beginning, the robot's choice, the way to the human, what a step showed, and what it wants of the next.
"""

from collections.abc import Collection, Sequence
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.base import Saved, choose, choose_as
from visitlab_cli.agents.exploration import Table, greedy
from visitlab_cli.compiled import Operation, array_kernel, kernel
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.simulation.estimates import Estimates, make_estimates, notice
from visitlab_cli.simulation.lead import Lead, leading_action, make_lead, offset_of, start_lead, sweep_lead
from visitlab_cli.simulation.learned_moves import Learning, learn_moves, make_learning
from visitlab_cli.simulation.successors import (
    Cells,
    Successors,
    follow_up,
    make_successors,
    towards,
)
from visitlab_cli.simulation.vehicle import plan_directions
from visitlab_cli.world.enums import N_DIRECTIONS, InteractionLevel
from visitlab_cli.world.geometry import is_appropriate
from visitlab_cli.world.go_to_human import go_to_human_state
from visitlab_cli.world.scene import Scene, with_wanted
from visitlab_cli.world.sight import Walls
from visitlab_cli.world.visit import VisitWorld

ROUTE, MASK, PLAN, LEAD = "route", "mask", "plan", "lead"
"""What a controller may do otherwise than the paper's."""
PLAN_EVERY = 10
"""Trials after which what has changed is planned with."""
FIRST_SWEEPS, MORE_SWEEPS = 10, 8
"""Of the lead plan: the first time, and from what it was."""


class Paper(NamedTuple):
    """The paper's visit; a type of its own, for which nothing of what follows is compiled."""

    none: int = 0


class Planned(NamedTuple):
    """`route`, `mask`, `plan`, `lead`: what it does otherwise; `estimates`: the human as far as it is known.

    `clock` (4,): trials begun; whether there is a plan; whether `known.after` has changed since, which whoever
    changes it says; whether anything is known of moving, without which there is nothing to plan.
    `learning` is whether `known` goes on. `rooms` (cells,) are the rooms of the cells of a lab with `cols` columns.
    """

    route: bool
    mask: bool
    plan: bool
    lead: bool
    known: Successors
    learning: Learning
    estimates: Estimates
    leading: Lead
    rooms: Cells
    cols: int
    clock: Cells


BEGUN, HAS_PLAN, IS_NEW, HAS_MODEL = range(4)
"""Of `clock`."""


def make_planned(
    options: Collection[str],
    world: VisitWorld,
    model: Saved,
    reach: int,
    told: tuple[tuple[float, ...], float] | None = None,
    window: int = 0,
    others: Sequence[VisitWorld] = (),
    learns: str | None = None,
) -> Planned:
    """A controller that has not planned yet.

    Args:
        options: of `ROUTE`, `MASK`, `PLAN`, `LEAD`.
        world: of the visit; nothing is asked of its human.
        model: what navigation has learned, `visits` and `successor_*` over (states, 25).
        reach: the largest appropriate distance, in cells.
        told: the human's p_S and p_A, where they are not to be estimated.
        window: estimates are over so many of the last chances; 0 for all.
        others: the worlds of later phases, which may have other walls and goals; sight is taken to be as in the first.
        learns: how what is known of moving goes on, `LAST_SEEN` or `OWN`; not at all unless given.
    """
    leads = LEAD in options
    rooms = world.lab.rooms.ravel()
    worlds = (world, *others)
    walled = any(isinstance(each.lab.walls, Walls) for each in worlds)
    known = make_successors(model, world.lab, walled=walled)
    # what does not lead has no use for the plan's tables
    ever = np.unique(np.concatenate([each.goal_rooms for each in worlds]))
    leading = make_lead(world.geometry, reach if leads else 0, rooms, ever)
    clock = np.zeros(4, np.int64)
    clock[HAS_MODEL] = len(model["successor_states"]) > 0
    estimates = make_estimates(window, told)
    chosen = (ROUTE in options, MASK in options, PLAN in options, leads)
    learning = make_learning(learns, model, known)
    return Planned(*chosen, known, learning, estimates, leading, rooms, world.lab.cols, clock)


def _prepare(controller, direction_values):  # type: ignore[no-untyped-def]
    """At a trial's beginning; may change `direction_values`, shape (goal rooms, rows, cols, 8)."""


def _decide(controller, agent, scene, state, step, random):  # type: ignore[no-untyped-def]
    """The action and whether it was drawn at random, as the social module's `choose`."""


def _approach(controller, go_to_human, scene, visible, random):  # type: ignore[no-untyped-def]
    """The physical action for 'go to human vision'; `go_to_human` is that module's Q.

    `visible` is whether robot and human see each other.
    """


def _observed(controller, before, after):  # type: ignore[no-untyped-def]
    """Learn what a step has shown."""


def _wanted(controller, scene):  # type: ignore[no-untyped-def]
    """The scene with where the controller wants robot and human."""


PREPARE, DECIDE, APPROACH = Operation(_prepare), Operation(_decide), Operation(_approach)
OBSERVED, WANTED = Operation(_observed), Operation(_wanted)
prepare, decide, approach = PREPARE.function, DECIDE.function, APPROACH.function
observed, wanted = OBSERVED.function, WANTED.function


@PREPARE.of(Paper)
def _prepare_nothing(controller: Paper, direction_values: Table) -> None:
    pass


@DECIDE.of(Paper)
def _social_module(
    controller: Paper, agent: Any, scene: Scene, state: int, step: int, random: RandomState
) -> tuple[int, bool]:
    return choose(agent, state, step, random)  # type: ignore[no-any-return]


@APPROACH.of(Paper)
def _go_to_human(controller: Paper, go_to_human: Table, scene: Scene, visible: bool, random: RandomState) -> int:
    return greedy(go_to_human[go_to_human_state(scene)], random)


@OBSERVED.of(Paper)
def _observe_nothing(controller: Paper, before: Scene, after: Scene) -> None:
    pass


@WANTED.of(Paper)
def _want_nothing(controller: Paper, scene: Scene) -> Scene:
    return scene


@PREPARE.of(Planned)
def _prepare_plan(controller: Planned, direction_values: Table) -> None:
    plan_if_due(controller, direction_values)


@array_kernel
def plan_if_due(controller: Planned, direction_values: Table) -> None:
    """Plan at first, and at every tenth trial where an estimate or a successor has changed."""
    clock, known, estimates, leading = controller.clock, controller.known, controller.estimates, controller.leading
    due = clock[BEGUN] % PLAN_EVERY == 0 and clock[HAS_MODEL]
    clock[BEGUN] += 1
    if not due:
        return
    changed = clock[IS_NEW] or not clock[HAS_PLAN] or leading.loss[0] != estimates.loss[0]
    changed = changed or (leading.speeds != estimates.speeds).any()
    if clock[IS_NEW]:
        follow_up(known)
        clock[IS_NEW] = 0
    if not (controller.plan and changed):
        return
    leading.speeds[:], leading.loss[:] = estimates.speeds, estimates.loss
    directions = direction_values.reshape((len(direction_values), len(controller.rooms), N_DIRECTIONS))
    plan_directions(known.after, controller.rooms, leading.speeds, directions)
    if controller.lead:
        if not clock[HAS_PLAN]:
            start_lead(leading, known, directions)
        for _ in range(MORE_SWEEPS if clock[HAS_PLAN] else FIRST_SWEEPS):
            sweep_lead(leading, known)
    clock[HAS_PLAN] = 1


@kernel
def leads_from(controller: Planned, scene: Scene) -> int:
    """The robot's offset from a human that follows and can be led; -1 where the social module acts."""
    if not controller.lead or scene.perceived_level != InteractionLevel.FOLLOWS or not is_appropriate(scene.distance):
        return -1
    return offset_of(controller.leading, controller.known, robot_cell(controller, scene), human_cell(controller, scene))


@kernel
def robot_cell(controller: Planned, scene: Scene) -> int:
    """The number of the robot's cell."""
    return scene.robot_row * controller.cols + scene.robot_col


@kernel
def human_cell(controller: Planned, scene: Scene) -> int:
    """The number of the human's cell."""
    return scene.human_row * controller.cols + scene.human_col


@DECIDE.of(Planned)
def _lead_or_choose(
    controller: Planned, agent: Any, scene: Scene, state: int, step: int, random: RandomState
) -> tuple[int, bool]:
    """Lead a human that follows, without exploring; else as the social module chooses, masked where that is on."""
    robot, human = robot_cell(controller, scene), human_cell(controller, scene)
    offset = leads_from(controller, scene)
    if offset >= 0:
        return leading_action(controller.leading, controller.known, scene.goal_room, human, robot, offset), False
    if controller.mask:
        return choose_as(agent, state, controller.known.meant[robot], step, random)  # type: ignore[no-any-return]
    return choose(agent, state, step, random)  # type: ignore[no-any-return]


@APPROACH.of(Planned)
def _by_the_route(controller: Planned, go_to_human: Table, scene: Scene, visible: bool, random: RandomState) -> int:
    """Out of sight of the human by the shortest known way to it; else, and where none is known, as the module says."""
    if controller.route and not visible:
        robot, human = robot_cell(controller, scene), human_cell(controller, scene)
        action = towards(controller.known, robot, human, random)
        if action >= 0:
            return action
    return greedy(go_to_human[go_to_human_state(scene)], random)


@OBSERVED.of(Planned)
def _notice(controller: Planned, before: Scene, after: Scene) -> None:
    if learn_moves(controller.learning, controller.known, before, after, controller.cols):
        controller.clock[IS_NEW] = 1
    if controller.plan:
        notice(controller.estimates, controller.known, before, after, controller.cols)


@WANTED.of(Planned)
def _want(controller: Planned, scene: Scene) -> Scene:
    """Where the next action sends the robot, and where the human, which follows, goes from its next cell.

    Its next cell is already settled by where the robot stands now, but for its speed, of which the likeliest is taken.
    """
    offset = leads_from(controller, scene)
    if offset < 0:
        return with_wanted(scene, False, 0, 0, 0, 0)
    leading, known = controller.leading, controller.known
    robot, human = robot_cell(controller, scene), human_cell(controller, scene)
    action = leading_action(leading, known, scene.goal_room, human, robot, offset)
    likeliest = N_DIRECTIONS * int(np.argmax(leading.speeds))
    robot = known.after[robot, action]
    human = known.after[human, likeliest + leading.direction[offset]]
    offset = offset_of(leading, known, robot, human)
    if offset >= 0:
        human = known.after[human, likeliest + leading.direction[offset]]
    place = known.place
    return with_wanted(scene, True, place[robot, 0], place[robot, 1], place[human, 0], place[human, 1])
