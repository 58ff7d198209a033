"""What is told beside the scene: captions, moments, states over time, reward and distance as curves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import rerun as rr

from visitlab_cli.agents.model_switching import NEW, SWITCH
from visitlab_cli.replay.stage import TIMELINE, Stage
from visitlab_cli.scene.colours import ACTION_COLOURS, GOAL, HUMAN, LEVEL_COLOURS, Colour
from visitlab_cli.scene.moments import moments
from visitlab_cli.scene.trial import Trial
from visitlab_cli.scene.words import (
    ACTION_KINDS,
    BELIEVED,
    LEVEL_NAMES,
    action_kind,
    believed,
    captions,
    direction_name,
    model_name,
    option_name,
    room_name,
)
from visitlab_cli.world.enums import DISTANCE_NAMES

GOAL_LANE, LEVEL, ACTION, MODEL = LANES = "goal", "interaction_level", "robot_action", "robot_model"
"""Entities, which the viewer shows in alphabetical order."""
BELIEF = "belief"
EVIDENCE = "evidence"
BEST_SHOWN = 3
"""Actions whose Q-values are told."""
GREY: Colour = (140, 140, 145)
ROOM_COLOURS: tuple[Colour, ...] = ((170, 140, 70), (120, 100, 60))
"""Rooms in turn; their names tell them apart."""
MODEL_COLOURS = ACTION_COLOURS


def draw_words(stage: Stage) -> None:
    """The caption of each step as a document, all captions and the moments as logs."""
    told = captions(stage.trial.steps, stage.trial.lab)
    stage.columns("captions", rr.TextLog.columns(text=told))
    pages = [_page(stage, step, text) for step, text in enumerate(told)]
    stage.columns("now", rr.TextDocument.columns(text=pages, media_type=["text/markdown"] * len(pages)))
    new = (moment for moment in moments(stage.trial.steps, stage.trial.lab) if moment.step >= stage.first)
    for moment in new:
        stage.recording.set_time("step", sequence=moment.step)
        stage.recording.log("moments", rr.TextLog(f"{moment.kind}: {told[moment.step]}"))
    stage.recording.reset_time()


def draw_states(stage: Stage) -> None:
    """Lanes over time: the interaction level, the kind of action, the goal room, which of several models is active."""
    steps = stage.trial.steps
    if stage.trial.has_human:
        _lane(stage, LEVEL, LEVEL_NAMES, LEVEL_COLOURS, [LEVEL_NAMES[level] for level in steps["interaction_level"]])
    actions = ["" if step == 0 else action_kind(int(action)) for step, action in enumerate(steps["action"])]
    _lane(stage, ACTION, ("", *ACTION_KINDS), ((60, 60, 60), *ACTION_COLOURS), actions)
    if stage.trial.has_goal:
        names = [room_name(stage.trial.lab, room) for room in range(stage.trial.lab.n_rooms)]
        colours = [ROOM_COLOURS[room % 2] for room in range(stage.trial.lab.n_rooms)]
        _lane(stage, GOAL_LANE, names, colours, [names[room] for room in steps["goal_room"]])
    if stage.trial.has_models:
        names = [f"model {model}" for model in range(int(steps["active_model"].max()) + 1)]
        colours = [MODEL_COLOURS[model % len(MODEL_COLOURS)] for model in range(len(names))]
        _lane(stage, MODEL, names, colours, [model_name(steps, step) for step in range(stage.trial.length)])


def draw_curves(stage: Stage) -> None:
    """The reward so far, what speaks for another model and how much is enough, the distance with its bounds.

    Between the bounds, in cells, the two can interact.
    """
    steps = stage.trial.steps
    reward = "goals" if stage.trial.plays.counts_goals else "reward"
    _curve(stage, "reward", np.cumsum(steps["reward"]), reward, GOAL, 2.5)
    if stage.trial.has_models:
        _curve(stage, f"{EVIDENCE}/nats", steps["evidence"], "nats", HUMAN, 2.5)
        for name, enough in (("for a model that is there", SWITCH), ("for a new one", NEW)):
            _curve(stage, f"{EVIDENCE}/{name.replace(' ', '_')}", np.full(stage.trial.length, enough), name, GREY, 1.0)
    if not stage.trial.has_human:
        return
    apart = [abs(steps[f"robot_{axis}"].astype(int) - steps[f"human_{axis}"].astype(int)) for axis in ("row", "col")]
    _curve(stage, "distance/cells", np.maximum(*apart), "cells", HUMAN, 2.5)
    too_close, *_, too_far = stage.trial.distances
    for name, bound in (("too close", too_close), ("too far", too_far)):
        _curve(stage, f"distance/{name.replace(' ', '_')}", np.full(stage.trial.length, bound), name, GREY, 1.0)


def draw_belief(stage: Stage) -> None:
    """What is believed of the human's engagement, at each step four bars: none, greeted, called, following."""
    if not stage.trial.has_belief:
        return
    values = np.stack([stage.trial.steps[name] for name in BELIEVED], axis=1)
    for step in range(stage.first, stage.trial.length):
        stage.recording.set_time(TIMELINE, sequence=step)
        stage.recording.log(BELIEF, rr.BarChart(values[step], color=HUMAN))
    stage.recording.reset_time()


def _page(stage: Stage, step: int, caption: str) -> str:
    """The caption in large letters, and the state it leads to."""
    steps = stage.trial.steps
    does, *outcome = caption.split("; ")
    lines = [f"## Step {step}: {does}", *(f"#### {part}" for part in outcome), ""]
    facts = []
    if stage.trial.has_human:
        level = int(steps["interaction_level"][step])
        facts.append(f"Level **{level} {LEVEL_NAMES[level]}**")
        facts.append(f"distance **{DISTANCE_NAMES[int(steps['distance'][step])]}**")
    if stage.trial.has_belief:
        facts.append(f"believed **{believed(steps, step)}**")
    if stage.trial.has_engagement:
        facts.append(f"desired direction **{direction_name(int(steps['desired_direction'][step]))}**")
    if stage.trial.has_goal:
        facts.append(f"goal **{room_name(stage.trial.lab, int(steps['goal_room'][step]))}**")
    if stage.trial.has_models:
        facts.append(f"acts by **{model_name(steps, step)}**")
    if steps["explored"][step]:
        facts.append("*drawn at random, to explore*")
    best = [_best_actions(stage.trial, int(steps["state"][step]))] if stage.trial.q is not None else []
    return "\n\n".join([*lines, ", ".join(facts), *best])


def _best_actions(trial: Trial, state: int) -> str:
    """The actions that are best in a state by what was learned in the end, with what was expected of them."""
    assert trial.q is not None
    values = trial.q[state]
    order = np.argsort(-values, kind="stable")[:BEST_SHOWN]
    told = [f"{option_name(int(action))} **{values[action]:.2f}**" for action in order]
    learned = "what was learned" if trial.q_of is None else f"model {trial.q_of} as it was"
    return f"Best from here, by {learned} in the end: {', '.join(told)}"


def _lane(stage: Stage, entity: str, names: Sequence[str], colours: Sequence[Colour], states: Sequence[str]) -> None:
    packed = np.array([(red << 24) | (green << 16) | (blue << 8) | 255 for red, green, blue in colours], np.uint32)
    stage.fixed(entity, rr.StateConfiguration(values=list(names), labels=list(names), colors=packed))
    stage.columns(entity, rr.StateChange.columns(state=states))


def _curve(stage: Stage, entity: str, values: npt.NDArray[Any], name: str, colour: Colour, width: float) -> None:
    stage.fixed(entity, rr.SeriesLines(colors=colour, names=name, widths=width, interpolation_mode="StepAfter"))
    stage.columns(entity, rr.Scalars.columns(scalars=values))
