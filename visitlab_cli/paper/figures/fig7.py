"""Fig. 7: the values of navigation that Q-learning has, alone or from watching another agent."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.paper.figures.source import Floats, Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import FONT_SIZE, GREEN, GREY, INK, PAGE, VERMILION
from visitlab_cli.results.estimates import half_width
from visitlab_cli.scene.words import room_name
from visitlab_cli.world.enums import MAX_SPEED
from visitlab_cli.world.lab import LAB_SIZE, N_ROOMS, ROOM_SIZE, ROOMS_PER_SIDE
from visitlab_cli.world.tasks import NAVIGATION

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

Integers = npt.NDArray[np.int64]

EXPERIMENT = "navigation_observed"
LEARNERS = {"mf": "alone", "mf_watching_mb": "watching model-based", "mf_watching_rmax": "watching R-max"}
EXAMPLE_ROOM = ROOMS_PER_SIDE - 1  # in the north-east, as in the paper
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


def distances() -> Integers:
    """Speed-1 actions until the first reward from each cell, shape (goal rooms, cells): 1 inside and beside it."""
    rows, cols = np.divmod(np.arange(LAB_SIZE**2), LAB_SIZE)
    rooms = np.arange(N_ROOMS)[:, None]
    north, west = rooms // ROOMS_PER_SIDE * ROOM_SIZE, rooms % ROOMS_PER_SIDE * ROOM_SIZE
    last = ROOM_SIZE - 1
    beyond = [north - rows, rows - north - last, west - cols, cols - west - last]
    steps: Integers = np.maximum.reduce([*beyond, np.ones_like(beyond[0])])
    return steps


def ratios(tables: Floats, optimal: Floats) -> Ratios:
    """Learned over optimal value of a state by its distance, over all states of all goal rooms.

    Args:
        tables: Q of each run, shape (runs, states, actions).
        optimal: shape (states, actions).
    """
    share = tables.max(axis=2) / optimal.max(axis=1)
    of_state = distances().ravel()
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
    upper, lower = figure.subplots(2, len(groups), squeeze=False, height_ratios=HEIGHT_RATIOS)
    for maps, bars, group in zip(upper, lower, groups, strict=True):
        optimal, tables = navigation_optimal_q(gamma_of(group)), group.tables()
        image = _draw_map(maps, tables[0], float(optimal.max()))
        maps.set_title(f"Model-free, {LEARNERS[group.cells[0].agent]}", loc="left", fontsize=FONT_SIZE)
        _draw_ratios(bars, ratios(tables, optimal), group.name)
    sizes = " to ".join(dict.fromkeys(str(size) for size in sorted({len(group.cells) for group in groups})))
    upper[0].set_ylabel(f"row\n(one run, goal {room_name(EXAMPLE_ROOM)}, outlined)")
    lower[0].set_ylabel(f"learned / optimal value\n({N_ROOMS} goal rooms, n = {sizes} runs)")
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


def _draw_map(axes: "Axes", table: Floats, highest: float) -> "AxesImage":
    """The best value of each cell, north up."""
    values = table.max(axis=1).reshape(N_ROOMS, LAB_SIZE, LAB_SIZE)[EXAMPLE_ROOM]
    image = axes.imshow(values, cmap=COLOUR_MAP, vmin=0, vmax=highest, extent=(0, LAB_SIZE, LAB_SIZE, 0))
    for line in range(ROOM_SIZE, LAB_SIZE, ROOM_SIZE):
        axes.axvline(line, color="white", linewidth=0.4, alpha=0.6)
        axes.axhline(line, color="white", linewidth=0.4, alpha=0.6)
    west, north = EXAMPLE_ROOM % ROOMS_PER_SIDE * ROOM_SIZE, EXAMPLE_ROOM // ROOMS_PER_SIDE * ROOM_SIZE
    east, south = west + ROOM_SIZE, north + ROOM_SIZE
    axes.plot([west, east, east, west, west], [north, north, south, south, north], color=VERMILION, clip_on=False)
    axes.set(xticks=range(0, LAB_SIZE + 1, ROOM_SIZE), yticks=range(0, LAB_SIZE + 1, ROOM_SIZE), xlabel="column")
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
