"""What an interaction was like, from a cell's log: gaze, time to engagement, distance, attention lost, the way walked.

Such numbers are told of robots among people by HuNavSim (Perez-Higueras et al., 2023), Habitat 3.0 (Puig et al.,
2024) and Arena; here distances are in cells and times in steps. docs/metrics.md has each definition.
"""

from collections.abc import Iterator, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.errors import NotFoundError
from visitlab_cli.log.reader import check_values, read_steps
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import model_of
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group, groups_of
from visitlab_cli.results.own_models import met
from visitlab_cli.results.phases import FIRST, checked_first
from visitlab_cli.results.units import Units, by_unit
from visitlab_cli.results.ways import distances_to
from visitlab_cli.storage.cell_folder import STEPS, read_cell
from visitlab_cli.wording import printable
from visitlab_cli.world.columns import BELIEF, COLUMNS, DOORS, ENGAGEMENT, GOAL, MODELS
from visitlab_cli.world.enums import DISTANCE_NAMES, InteractionLevel
from visitlab_cli.world.geometry import BEHIND, CIRCLE, FACING_FIELD, HUNDREDTHS, make_geometry
from visitlab_cli.world.lab import ALL_OPEN, Lab

Values = npt.NDArray[Any]
Steps = dict[str, Values]
SHARE, STEPS_UNIT, PER_HUNDRED, RATIO = "share", "steps", "per 100 steps", "ratio"


class Metric(NamedTuple):
    """A number of an interaction: its `unit`, and what it `is`."""

    unit: str
    what: str


_UNTIL = {
    "seen": "the human sees the robot",
    "greeted": "the human is greeted, or engaged further",
    "following": "the human follows",
}
METRICS = {
    "robot_gaze": Metric(SHARE, "steps after which the robot faces the human"),
    "human_gaze": Metric(SHARE, "steps after which the human faces the robot"),
    **{
        f"steps_until_{name}": Metric(STEPS_UNIT, f"until {what}, of trials in which that is so")
        for name, what in _UNTIL.items()
    },
    **{f"trials_{name}": Metric(SHARE, f"trials in which {what}") for name, what in _UNTIL.items()},
    "steps_until_goal": Metric(STEPS_UNIT, "until the first goal, of trials in which one is reached"),
    "trials_goal": Metric(SHARE, "trials in which a goal is reached"),
    **{name.replace(" ", "_"): Metric(SHARE, f"steps after which the distance is {name}") for name in DISTANCE_NAMES},
    "following": Metric(SHARE, "steps after which the human follows"),
    "attention_lost": Metric(PER_HUNDRED, "times that an engaged human is engaged no more"),
    "steps_until_back": Metric(
        STEPS_UNIT, "from a loss until the human is engaged again, of losses that are made good"
    ),
    "attention_back": Metric(SHARE, "losses that are made good in the same trial"),
    "belief_right": Metric(SHARE, "steps after which the likeliest engagement is the true one"),
    "belief_right_engaged": Metric(SHARE, "the same, of steps after which the human is engaged"),
    "own_model": Metric(SHARE, "steps chosen by the human's own model, which no other human had more often"),
    "steps_until_own_model": Metric(STEPS_UNIT, "from a phase's beginning until that model is active"),
    "path_efficiency": Metric(
        RATIO, "the human's shortest way to a goal over the way that it walked, of goals reached"
    ),
}
"""Every metric by name, in the order in which they are told; the last, and those of goals, are of a visit."""


class Part(NamedTuple):
    """Which trials: of a `phase` its first ones or the rest, in words; all of a cell without phases."""

    phase: int | None = None
    trials: str = ""


WHOLE = Part()
BELIEFS = tuple(column.name for column in COLUMNS if column.part == BELIEF)
"""Columns of what is believed, by `Engagement`."""
(OPEN_DOORS,) = (column.name for column in COLUMNS if column.part == DOORS)


def metrics_of(run: Path, cell: Cell, first: int = FIRST) -> dict[Part, dict[str, float]]:
    """The metrics of each part of a finished cell whose human can be engaged, by name; without those it does not have.

    Args:
        run: the run's folder.
        cell: a cell of its plan.
        first: how many trials are a phase's first ones, where there are phases.

    Raises:
        NotFoundError: the cell has no log.
        RunError: it is damaged, or has values that there are not.
    """
    file = run / cell.path / STEPS
    if not file.is_file():
        raise NotFoundError(f"{file.parent}: has no log, its config records no steps; run it with record.steps=every")
    names = ["trial", "step", "reward", "robot_row", "robot_col", "robot_heading", "human_row", "human_col"]
    names += ["human_heading", "interaction_level", "distance"]
    names += ["goal_room"] if cell.settings.plays.has(GOAL) else []
    names += ["phase"] if cell.settings.phases else []
    names += BELIEFS if BELIEF in cell.parts else ()
    names += [OPEN_DOORS] if DOORS in cell.parts else []
    steps, lab = read_steps(file, names), lab_of(cell.settings)
    check_values(file, steps, cell.task, lab)
    if not cell.settings.phases:
        return {WHOLE: measured(steps, lab)}
    parts: dict[Part, Values] = {}
    begins = 0
    for number, trials in enumerate(cell.settings.phase_trials):
        of_phase, until = steps["phase"] == number, np.uint32(begins + first)
        parts[Part(number, f"first {first}")] = of_phase & (steps["trial"] < until)
        parts[Part(number, "rest")] = of_phase & (steps["trial"] >= until)
        begins += trials
    chosen = {part: {name: column[rows] for name, column in steps.items()} for part, rows in parts.items()}
    labs = cell.settings.labs
    found = {part: measured(of, labs[part.phase or 0]) for part, of in chosen.items() if len(of["step"])}
    if MODELS in cell.parts and cell.settings.phases:
        for number, phase in enumerate(met(cell, model_of(run, cell))):
            early = first * cell.settings.trial_steps
            for words, own in ((f"first {first}", phase.own[:early]), ("rest", phase.own[early:])):
                if (part := Part(number, words)) in found:
                    found[part] |= {"own_model": _share(own)}
            if (part := Part(number, f"first {first}")) in found:
                found[part] |= {"steps_until_own_model": phase.delay}
    return found


def measured(steps: Steps, lab: Lab) -> dict[str, float]:
    """The metrics of recorded steps, whole trials from their step 0 on, that were played in `lab`.

    Its doors are as `steps` say, open where they say nothing.
    """
    after = steps["step"] > 0
    level = steps["interaction_level"]
    found = _gaze(steps, after)
    for name, least in (
        ("seen", InteractionLevel.SEEN),
        ("greeted", InteractionLevel.GREETED),
        ("following", InteractionLevel.FOLLOWS),
    ):
        found |= _until(name, steps, level >= least)
    found |= {
        name.replace(" ", "_"): _share(steps["distance"][after] == number) for number, name in enumerate(DISTANCE_NAMES)
    }
    found["following"] = _share(level[after] == InteractionLevel.FOLLOWS)
    found |= _attention(steps, level >= InteractionLevel.GREETED)
    if BELIEFS[0] in steps:
        found |= _beliefs(steps, after, np.maximum(level.astype(np.int64) - InteractionLevel.BOTH_FACE, 0))
    if "goal_room" in steps:
        found |= _until("goal", steps, after & (steps["reward"] > 0)) | _paths(steps, lab)
    return {name: found[name] for name in METRICS if name in found}


def _share(flags: Values) -> float:
    return float(flags.mean()) if len(flags) else float("nan")


def _mean(values: Sequence[float] | Values) -> float:
    return float(np.mean(values)) if len(values) else float("nan")


def _gaze(steps: Steps, after: Values) -> dict[str, float]:
    north = steps["robot_row"].astype(np.int64) - steps["human_row"]
    east = steps["human_col"].astype(np.int64) - steps["robot_col"]
    size = int(max(abs(north).max(), abs(east).max())) + 1
    geometry = make_geometry(size, size)
    bearing = geometry.bearing[north + geometry.reach, east + geometry.reach]
    return {
        "robot_gaze": _share(_faces(steps["robot_heading"], bearing)[after]),
        "human_gaze": _share(_faces(steps["human_heading"], bearing + BEHIND)[after]),
    }


def _faces(heading: Values, bearing: Values) -> Values:
    turn = (heading.astype(np.int64) * HUNDREDTHS - bearing) % CIRCLE
    return np.minimum(turn, CIRCLE - turn) <= FACING_FIELD


def _begins(steps: Steps) -> Values:
    """The first row of each trial, and the number of rows."""
    return np.append(np.flatnonzero(steps["step"] == 0), len(steps["step"]))


def _until(name: str, steps: Steps, is_so: Values) -> dict[str, float]:
    """In which trials something becomes so, and from which of their steps on, 0 being the state that they begin in."""
    begins = _begins(steps)
    rows = np.flatnonzero(is_so)
    first = np.searchsorted(rows, begins[:-1])
    met = first < len(rows)
    met[met] = rows[first[met]] < begins[1:][met]
    return {f"steps_until_{name}": _mean(steps["step"][rows[first[met]]]), f"trials_{name}": _share(met)}


def _attention(steps: Steps, engaged: Values) -> dict[str, float]:
    begins = _begins(steps)
    within = steps["step"] > 0
    lost = np.flatnonzero(within[1:] & engaged[:-1] & ~engaged[1:]) + 1
    rows = np.flatnonzero(engaged)
    ends = begins[np.searchsorted(begins, lost, side="right")]
    again = np.searchsorted(rows, lost)
    back = again < len(rows)
    back[back] = rows[again[back]] < ends[back]
    return {
        "attention_lost": 100 * len(lost) / max(1, int(within.sum())),
        "steps_until_back": _mean(rows[again[back]] - lost[back]),
        "attention_back": _share(back),
    }


def _beliefs(steps: Steps, after: Values, engagement: Values) -> dict[str, float]:
    right = np.argmax(np.stack([steps[name] for name in BELIEFS]), axis=0) == engagement
    return {"belief_right": _share(right[after]), "belief_right_engaged": _share(right[after & (engagement > 0)])}


def _paths(steps: Steps, lab: Lab) -> dict[str, float]:
    """Of each goal that is reached: from where the human stood when it was set."""
    rows, cols = steps["human_row"].astype(np.int64), steps["human_col"].astype(np.int64)
    walked = np.maximum(abs(np.diff(rows, prepend=rows[0])), abs(np.diff(cols, prepend=cols[0])))
    walked[steps["step"] == 0] = 0
    so_far = np.cumsum(walked)
    doors = steps.get(OPEN_DOORS, np.full(len(rows), ALL_OPEN))
    away = cache(partial(distances_to, lab))
    ratios: list[float] = []
    since = 0
    reached = (steps["step"] > 0) & (steps["reward"] > 0)
    for row in np.flatnonzero(reached | (steps["step"] == 0)).tolist():
        if reached[row]:
            shortest = away(int(steps["goal_room"][since]), int(doors[since]))[rows[since], cols[since]]
            walk = so_far[row] - so_far[since]
            if walk > 0:  # else it stood there already
                ratios.append(min(1.0, float(shortest / walk)))
        since = row
    return {"path_efficiency": _mean(ratios)}


class GroupMetrics(NamedTuple):
    """The metrics of a part of a group: of each that it has, the mean over its independent units, and how many have it.

    `human` is whom it meets there.
    """

    group: Group
    part: Part
    human: str
    values: dict[str, tuple[Estimate, Units]]

    def as_rows(self) -> list[dict[str, Any]]:
        """A line a metric, as plain values."""
        evaluation = self.group.evaluation
        return [
            {
                "experiment": self.group.experiment,
                "agent": self.group.agent,
                "human": self.human or None,
                "point": dict(self.group.point),
                **({} if self.part == WHOLE else self.part._asdict()),
                **({"played": evaluation.words} if evaluation.folder else {}),
                "metric": name,
                "unit": METRICS[name].unit,
                "n": units.n,
                "n_of": units.of,
                **estimate.as_json(),
            }
            for name, (estimate, units) in self.values.items()
        ]


def group_metrics(run: Path, cells: Sequence[Cell], first: int = FIRST, human: str = "") -> list[GroupMetrics]:
    """The metrics of each group of a run's finished cells whose human can be engaged, of each part where it has phases.

    Args:
        run: the run's folder.
        cells: of its plan.
        first: how many trials are a phase's first ones.
        human: if given, only what was with this one; of phases those with it.

    Raises:
        NotFoundError: there is no such cell.
        UsageError: `first` is no whole number from 1.
        RunError: a log is damaged.
    """
    first = checked_first(first)
    wanted = [cell for cell in cells if human in ("", cell.human, *cell.humans)]
    social = [cell for cell in wanted if cell.settings.plays.has(ENGAGEMENT)]
    done = [cell for cell in social if read_cell(run / cell.path) is not None]
    if not done:
        what = "no finished cell" if social else "no training of the social module and no visit"
        whom = f" with {printable(human)}" if human else ""
        raise NotFoundError(f"{run}: has {what}{whom}, and metrics are of these")
    found = [each for group in groups_of(done) for each in _of_group(run, group, first)]
    return [each for each in found if human in ("", each.human, each.group.human)]


def _of_group(run: Path, group: Group, first: int) -> Iterator[GroupMetrics]:
    found = [[metrics_of(run, cell, first) for cell in members] for members in by_unit(group.cells).values()]
    phases = group.cells[0].settings.phases
    for part in found[0][0]:
        human = group.human if part.phase is None else phases[part.phase].met
        of_units = [[cell.get(part, {}) for cell in members] for members in found]
        yield GroupMetrics(group, part, human, _means(of_units))


def _means(of_units: Sequence[Sequence[dict[str, float]]]) -> dict[str, tuple[Estimate, Units]]:
    """Of each metric that a cell has."""
    values = {}
    for name in METRICS:
        means = [np.nanmean(each) for unit in of_units if (each := _known(unit, name))]
        if means:
            cells = sum(len(_known(unit, name)) for unit in of_units)
            values[name] = mean_of([float(mean) for mean in means]), Units(len(means), cells)
    return values


def _known(cells: Sequence[dict[str, float]], name: str) -> list[float]:
    return [cell[name] for cell in cells if not np.isnan(cell.get(name, float("nan")))]
