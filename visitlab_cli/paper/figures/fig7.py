"""Fig. 7: the values of navigation that Q-learning has, alone or from watching another agent."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.paper.figures.source import Floats, Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import FONT_SIZE, GREEN, GREY, INK, PAGE, VERMILION
from visitlab_cli.results.estimates import half_width
from visitlab_cli.scene.words import room_name
from visitlab_cli.world.enums import MAX_SPEED
from visitlab_cli.world.lab import Lab, box_of
from visitlab_cli.world.tasks import NAVIGATION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

Integers = npt.NDArray[np.int64]

EXPERIMENT = "navigation_observed"
LEARNERS = {"mf": "alone", "mf_watching_mb": "watching model-based", "mf_watching_rmax": "watching R-max"}
EXAMPLE_ROOM = 2  # in the north-east, as in the paper
COLOUR_MAP = "viridis"
GAMMA = 0.9  # of an agent that discounts nothing
FULL, BETWEEN = GREEN, "#A6D8C9"
FULL_NAME, BETWEEN_NAME = "distance of whole moves at speed 3", "other distances"
HEIGHT, HEIGHT_RATIOS = 4.6, (1.2, 1)  # inches


class Ratios(NamedTuple):
    """Learned over optimal values: `distance`, `mean` and the `half` width of its interval, shape (distances,)."""

    distance: Integers
    mean: Floats
    half: Floats


def distances(lab: Lab) -> Integers:
    """Speed-1 actions until the first reward from each cell, shape (goal rooms, cells): 1 inside and beside it."""
    cells = np.stack(np.divmod(np.arange(lab.rows * lab.cols), lab.cols), axis=1)
    ends = [cells[lab.rooms.ravel() == room] for room in range(lab.n_rooms)]
    away = [np.abs(cells[:, None] - inside).max(axis=2).min(axis=1) for inside in ends]
    steps: Integers = np.maximum(np.stack(away), 1)
    return steps


def ratios(tables: Floats, optimal: Floats, lab: Lab) -> Ratios:
    """Learned over optimal value of a state by its distance, over all states of all goal rooms.

    Args:
        tables: Q of each run, shape (runs, states, actions).
        optimal: shape (states, actions).
        lab: without walls.
    """
    share = tables.max(axis=2) / optimal.max(axis=1)
    of_state = distances(lab).ravel()
    steps = np.unique(of_state)
    of_run = np.stack([share[:, of_state == step].mean(axis=1) for step in steps], axis=1)
    return Ratios(steps, of_run.mean(axis=0), half_width(of_run))


def draw_fig7(source: Source) -> Drawing:
    """Maps of one run for one goal room; below, learned over optimal values by distance, over all runs and rooms."""
    names = [f"{EXPERIMENT}/{agent}" for agent in LEARNERS]
    notes = source.lacks(names)
    groups = [source.groups[name] for name in names if name in source.groups]
    if not groups or groups[0].cells[0].task != NAVIGATION:
        return Drawing(None, notes)
    if shortfall := source.shortfall(names):
        notes.append(shortfall)
    return Drawing(_draw(groups), notes)


def _draw(groups: Sequence[Group]) -> "Figure":
    from matplotlib.figure import Figure

    figure = Figure(figsize=(PAGE, HEIGHT), layout="constrained")
    lab = lab_of(groups[0].cells[0].settings)
    upper, lower = figure.subplots(2, len(groups), squeeze=False, height_ratios=HEIGHT_RATIOS)
    for maps, bars, group in zip(upper, lower, groups, strict=True):
        optimal, tables = navigation_optimal_q(gamma_of(group), lab), group.tables()
        image = _draw_map(maps, tables[0], float(optimal.max()), lab)
        maps.set_title(f"Model-free, {LEARNERS[group.cells[0].agent]}", loc="left", fontsize=FONT_SIZE)
        _draw_ratios(bars, ratios(tables, optimal, lab), group.name)
    sizes = " to ".join(dict.fromkeys(str(size) for size in sorted({len(group.cells) for group in groups})))
    upper[0].set_ylabel(f"row\n(one run, goal {room_name(lab, EXAMPLE_ROOM)}, outlined)")
    lower[0].set_ylabel(f"learned / optimal value\n({lab.n_rooms} goal rooms, n = {sizes} runs)")
    handles, labels = lower[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, columnspacing=2.5)
    bar = figure.colorbar(image, ax=list(upper), shrink=0.9, pad=0.015)
    bar.set_label("highest Q of each cell\n(discounted reward)")
    bar.outline.set_linewidth(0.4)
    return figure


def gamma_of(group: Group) -> float:
    """The discount factor that a group's table was learned with."""
    cell = group.cells[0]
    parameters = cell.config.agents[cell.agent].learner_among(cell.config.agents)
    return float(getattr(parameters, "gamma", GAMMA))


def _draw_map(axes: "Axes", table: Floats, highest: float, lab: Lab) -> "AxesImage":
    """The best value of each cell, north up."""
    values = table.max(axis=1).reshape(lab.n_rooms, lab.rows, lab.cols)[EXAMPLE_ROOM]
    image = axes.imshow(values, cmap=COLOUR_MAP, vmin=0, vmax=highest, extent=(0, lab.cols, lab.rows, 0))
    boxes = [box_of(lab, room) for room in range(lab.n_rooms)]
    cols, rows = sorted({box.col for box in boxes}), sorted({box.row for box in boxes})
    for line in cols[1:]:
        axes.axvline(line, color="white", linewidth=0.4, alpha=0.6)
    for line in rows[1:]:
        axes.axhline(line, color="white", linewidth=0.4, alpha=0.6)
    north, west, height, width = boxes[EXAMPLE_ROOM]
    east, south = west + width, north + height
    axes.plot([west, east, east, west, west], [north, north, south, south, north], color=VERMILION, clip_on=False)
    axes.set(xticks=[*cols, lab.cols], yticks=[*rows, lab.rows], xlabel="column")
    axes.spines[:].set_visible(False)
    return image


def _draw_ratios(axes: "Axes", found: Ratios, group: str) -> None:
    whole = found.distance % MAX_SPEED == 0
    for chosen, colour, name in ((whole, FULL, FULL_NAME), (~whole, BETWEEN, BETWEEN_NAME)):
        bars = axes.bar(
            found.distance[chosen], found.mean[chosen], 0.8, color=colour, edgecolor=INK, linewidth=0.3, label=name
        )
        for bar, distance in zip(bars, found.distance[chosen], strict=True):
            bar.set_gid(f"{group}/{distance}")
    axes.errorbar(
        found.distance,
        found.mean,
        found.half,
        linestyle="",
        color=INK,
        elinewidth=0.8,
        capsize=1.6,
        capthick=0.6,
        label="95% interval of the mean over the runs (Student's t)",
    )
    axes.axhline(1, color=GREY, linewidth=0.8, label="optimum, exact")
    axes.set(ylim=(0, 1.05), xlim=(0.3, found.distance[-1] + 0.7), xticks=found.distance[::3])
    axes.set_xlabel("speed-1 actions to the first reward")
