"""How the viewer lays a trial out: the scene, the words beside it, lanes and curves over the steps."""

import numpy as np
import numpy.typing as npt
import rerun.blueprint as rrb

from visitlab_cli.replay.curves import ACTION, GOAL_LANE, LANES, LEVEL
from visitlab_cli.replay.stage import TIMELINE
from visitlab_cli.replay.trial import Trial
from visitlab_cli.story import FLOOR, moments, strip_steps
from visitlab_cli.world.lab import LAB_SIZE
from visitlab_cli.world.tasks import VISIT

Range = tuple[float, float]
MARGIN = 0.6
LEAST_VIEW = 24.0
FRAMES_PER_SECOND = 3.0
SCENE = ["lab/**", "human/**", "robot/**"]
STRIP_COLUMNS = 3
NO_LEGEND = rrb.PlotLegend(visible=False)


def view_of(trial: Trial) -> tuple[Range, Range]:
    """What is seen of the world, as ranges of x and y in cells: the whole lab, or where the two are."""
    if trial.has_rooms:
        whole = -MARGIN, LAB_SIZE + MARGIN
        return whole, whole
    places = np.concatenate([trial.places("robot"), trial.places("human")])
    places = places[_together(trial)]
    low, high = places.min(axis=0), places.max(axis=0)
    middle, side = (low + high) / 2, max(LEAST_VIEW, float((high - low).max()) + 8)
    (x, y), half = middle, side / 2
    return (float(x - half), float(x + half)), (float(y - half), float(y + half))


def _together(trial: Trial) -> npt.NDArray[np.bool_]:
    """Which of the robot's places, then the human's, are seen: not those before the robot comes to the human."""
    apart = np.abs(trial.places("robot") - trial.places("human")).max(axis=1)
    return np.concatenate([apart <= LEAST_VIEW / 2, np.ones(trial.length, np.bool_)])


def blueprint_of(trial: Trial) -> rrb.Blueprint:
    """The layout for the trial's task."""
    scene = _scene(trial, f"{trial.cell}, trial {trial.number}", SCENE)
    steps = strip_steps(trial.steps)
    panels = [_scene(trial, _panel_name(trial, step), [*SCENE, "- human/field/**"], step) for step in steps]
    left = rrb.Tabs(scene, rrb.Grid(*panels, grid_columns=STRIP_COLUMNS, name="Strip"))
    words: list[rrb.View | rrb.Container] = [
        rrb.TextDocumentView(origin="now", name="Now"),
        rrb.Tabs(_log("moments", "Moments"), _log("captions", "Every step")),
    ]
    first, last = (rrb.TimeRangeBoundary.absolute(seq=step) for step in (0, trial.last_step))
    axis = rrb.archetypes.TimeAxis(view_range=rrb.TimeRange(start=first, end=last))
    reward = "Goals reached" if trial.task == VISIT else "Reward so far"
    curves = [rrb.TimeSeriesView(origin="reward", name=reward, axis_x=axis, plot_legend=NO_LEGEND)]
    if trial.has_human:
        distance = "Distance in cells, to interact between the lines"
        curves.append(rrb.TimeSeriesView(origin="distance", name=distance, axis_x=axis, plot_legend=NO_LEGEND))
    there = {LEVEL: trial.has_human, ACTION: True, GOAL_LANE: trial.has_goal}
    lanes = [lane for lane in LANES if there[lane]]
    names = ", ".join(lane.replace("_", " ") for lane in lanes).capitalize()
    states = rrb.StateTimelineView(origin="/", contents=lanes, name=names, time_view=axis)
    side = rrb.Vertical(*words, rrb.Horizontal(*curves), row_shares=[3.2, 3.9, 2.7])
    return rrb.Blueprint(
        rrb.Vertical(rrb.Horizontal(left, side, column_shares=[1, 1]), states, row_shares=[4.4, 1]),
        rrb.TimePanel(timeline=TIMELINE, fps=FRAMES_PER_SECOND, play_state="paused", state="collapsed"),
        rrb.SelectionPanel(state="hidden"),
        rrb.BlueprintPanel(state="hidden"),
        rrb.TopPanel(state="hidden"),
    )


def _scene(trial: Trial, name: str, contents: list[str], step: int | None = None) -> rrb.Spatial2DView:
    """The scene at the time that the viewer shows, or always at one `step`."""
    x_range, y_range = view_of(trial)
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
    kinds = [kind for at, kind in moments(trial.steps) if at == step]
    return f"{step}: {', '.join(kinds) or 'start'}"


def _log(entity: str, name: str) -> rrb.TextLogView:
    return rrb.TextLogView(
        origin=entity, name=name, columns=rrb.TextLogColumns(timeline_columns=[TIMELINE], text_log_columns=["Body"])
    )
