"""How the viewer lays a trial out: the scene, the words beside it, lanes and curves over the steps."""

from typing import Literal

import rerun.blueprint as rrb

from visitlab_cli.replay.curves import ACTION, BELIEF, EVIDENCE, GOAL_LANE, LANES, LEVEL, MODEL
from visitlab_cli.replay.stage import TIMELINE
from visitlab_cli.scene.colours import FLOOR
from visitlab_cli.scene.moments import moments, strip_steps
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.trial import Trial

FRAMES_PER_SECOND = 3.0
SCENE = ["lab/**", "human/**", "robot/**"]
STRIP_COLUMNS = 3
DISTANCE, BELIEVED, FOR_OTHERS = "Distance in cells", "None to following", "Evidence in nats"
"""Names of curves, so short that three fit side by side."""
MOST_BESIDE = 3
"""Curves in a row."""
NO_LEGEND = rrb.PlotLegend(visible=False)


def blueprint_of(shown: Scene, *, following: bool = False) -> rrb.Blueprint:
    """The layout for the trial's task; it begins at the trial's start, or is always `following` its last step."""
    trial = shown.trial
    scene = _scene(shown, trial.name, SCENE)
    steps = strip_steps(trial.steps, trial.lab)
    panels = [_scene(shown, _panel_name(trial, step), [*SCENE, "- human/field/**"], step) for step in steps]
    left = rrb.Tabs(scene, rrb.Grid(*panels, grid_columns=STRIP_COLUMNS, name="Strip"))
    words: list[rrb.View | rrb.Container] = [
        rrb.TextDocumentView(origin="now", name="Now"),
        rrb.Tabs(_log("moments", "Moments"), _log("captions", "Every step")),
    ]
    first, last = (rrb.TimeRangeBoundary.absolute(seq=step) for step in (0, trial.last_step))
    axis = rrb.archetypes.TimeAxis(view_range=rrb.TimeRange(start=first, end=last))
    reward = "Goals reached" if trial.plays.counts_goals else "Reward so far"
    curves: list[rrb.View | rrb.Container] = [
        rrb.TimeSeriesView(origin="reward", name=reward, axis_x=axis, plot_legend=NO_LEGEND)
    ]
    if trial.has_human:
        curves.append(rrb.TimeSeriesView(origin="distance", name=DISTANCE, axis_x=axis, plot_legend=NO_LEGEND))
    if trial.has_belief:
        curves.append(rrb.BarChartView(origin=BELIEF, name=BELIEVED))
    if trial.has_models:
        curves.append(rrb.TimeSeriesView(origin=EVIDENCE, name=FOR_OTHERS, axis_x=axis, plot_legend=NO_LEGEND))
    there = {LEVEL: trial.has_human, ACTION: True, GOAL_LANE: trial.has_goal, MODEL: trial.has_models}
    lanes = [lane for lane in LANES if there[lane]]
    names = ", ".join(lane.replace("_", " ") for lane in lanes).capitalize()
    state: Literal["following", "paused"] = "following" if following else "paused"
    states = rrb.StateTimelineView(origin="/", contents=lanes, name=names, time_view=axis)
    columns = len(curves) if len(curves) <= MOST_BESIDE else MOST_BESIDE - 1
    side = rrb.Vertical(*words, rrb.Grid(*curves, grid_columns=columns), row_shares=[3.2, 3.9, 2.7])
    return rrb.Blueprint(
        rrb.Vertical(
            rrb.Horizontal(left, side, column_shares=[1, 1]), states, row_shares=[4.4, max(3, len(lanes)) / 3]
        ),
        rrb.TimePanel(timeline=TIMELINE, fps=FRAMES_PER_SECOND, play_state=state, state="collapsed"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.TopPanel(state="hidden"),
    )


def _scene(shown: Scene, name: str, contents: list[str], step: int | None = None) -> rrb.Spatial2DView:
    """The scene at the time that the viewer shows, or always at one `step`."""
    x_range, y_range = shown.view
    ranges = None
    if step is not None:
        here = rrb.TimeRangeBoundary.absolute(seq=step)
        ranges = rrb.VisibleTimeRanges([rrb.VisibleTimeRange(TIMELINE, start=here, end=here)])
    return rrb.Spatial2DView(
        origin="/",
        contents=contents,
        name=name,
        background=[*FLOOR, 255],
        visual_bounds=rrb.VisualBounds2D(x_range=x_range, y_range=y_range),
        time_ranges=ranges,
    )


def _panel_name(trial: Trial, step: int) -> str:
    kinds = [kind for at, kind in moments(trial.steps, trial.lab) if at == step]
    return f"{step}: {', '.join(kinds) or 'start'}"


def _log(entity: str, name: str) -> rrb.TextLogView:
    return rrb.TextLogView(
        origin=entity, name=name, columns=rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["Body"])
    )
