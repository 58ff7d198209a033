"""The figure of phases: for each experiment that has some its learning curves, behind them a band for each phase."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from visitlab_cli.colours import looks_of
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.phases import Phase
from visitlab_cli.paper.figures.learning import measure_of, x_of
from visitlab_cli.paper.figures.source import Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.height import top_of
from visitlab_cli.pictures.style import FONT_SIZE, GREY, INK, PAGE, SMALL
from visitlab_cli.pictures.words import width_of
from visitlab_cli.results.curves import Curve, Integers, curve_of
from visitlab_cli.results.groups import Group, groups_of
from visitlab_cli.results.units import mean_over
from visitlab_cli.results.varying import names_within, varying

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

PANEL_HEIGHT, SIDES = 2.3, 0.9  # inches; what axis and labels take of the width
BATCHES, FEWEST = 90, 6
"""Points of a curve in all, and at least of a phase that has as many trials."""
TINTS = ("#ffffff", "#ebebeb", "#f8f0d9", "#dfe7dc", "#f3e3e3", "#e2dfec")
"""Bands: each human has one of its own, so that an old friend is seen to return; without humans they take turns."""
TOP = 1.15
"""How far a panel reaches above the highest mean."""
TITLE_PAD = 14  # points: between title and panel stand the names of the phases
LINES, MARKERS = ("-", "--", ":", "-."), 15
NOTE = "bands: phases, one human has one colour; shades: 95% interval of the mean (Student's t), with several seeds"


def draw_phases(source: Source) -> Drawing:
    """A panel for each experiment with phases, and in a grid for each of their sequences."""
    groups = groups_of([cell for group in source.groups.values() for cell in group.cells if cell.settings.phases])
    panels: dict[object, list[Group]] = {}
    for group in groups:
        panels.setdefault((group.experiment, group.cells[0].settings.phases), []).append(group)
    return Drawing(_figure(source, list(panels.values())) if panels else None, [])


def edges_of(settings: Experiment) -> Integers:
    """Where batches of trials begin and the last one ends: no batch lies in two phases."""
    edges = [np.zeros(1, np.int64)]
    begins = 0
    for trials in settings.phase_trials:
        batches = min(trials, max(FEWEST, round(BATCHES * trials / settings.n_trials)))
        edges.append(np.linspace(begins, begins + trials, batches + 1).round().astype(np.int64)[1:])
        begins += trials
    return np.concatenate(edges)


def _figure(source: Source, panels: Sequence[Sequence[Group]]) -> "Figure":
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06)
    figure = Figure(figsize=(PAGE, len(panels) * PANEL_HEIGHT), layout=layout)
    figure.supxlabel(NOTE, fontsize=SMALL, color=GREY)
    comparable: dict[str, dict[Axes, list[Curve]]] = {}
    for axes, groups in zip(figure.subplots(len(panels), squeeze=False).flat, panels, strict=True):
        comparable.setdefault(measure_of(groups[0].cells[0]), {})[axes] = _draw(axes, source, groups)
    for alike in comparable.values():
        top = top_of([curve for curves in alike.values() for curve in curves], TOP)
        for axes in alike:
            axes.set_ylim(0, top)
    return figure


def _draw(axes: "Axes", source: Source, groups: Sequence[Group]) -> list[Curve]:
    """Its curves, which are given back."""
    cell = groups[0].cells[0]
    curves = [curve_of(source.run, group.cells, edges_of(cell.settings)) for group in groups]
    looks = looks_of(source.config.agents)
    names = names_within(groups, varying(group.point for group in groups))
    of_agent: dict[str, int] = {}
    for group, curve, name in zip(groups, curves, names, strict=True):
        dashes = LINES[of_agent.setdefault(group.agent, 0) % len(LINES)]
        of_agent[group.agent] += 1
        look = looks[group.agent]
        if curve.counted.n > 1:
            low, high = curve.mean - curve.half, curve.mean + curve.half
            axes.fill_between(curve.x, low, high, color=look.colour, alpha=0.2, lw=0, zorder=3)
        for part in _parts(curve, cell.settings):  # a curve does not run on from phase to phase
            (drawn,) = axes.plot(
                curve.x[part], curve.mean[part], color=look.colour, linestyle=dashes, linewidth=1.2, zorder=4
            )
            drawn.set(marker=look.marker, markersize=3.2, markevery=max(1, len(curve.x) // MARKERS))
        drawn.set(label=name, gid=group.path)
    end = float(curves[0].edges[-1] * curves[0].trial)
    unit, x_label = x_of(cell, end)
    axes.set_title(groups[0].experiment, loc="left", pad=TITLE_PAD)
    axes.set_xlabel(x_label)
    axes.set_ylabel(f"{measure_of(cell)}\n({mean_over([curve.counted for curve in curves])})")
    axes.set_xlim(0, end)
    axes.xaxis.set_major_formatter(lambda x, _: f"{x / unit:g}")
    _draw_bands(axes, cell.settings, curves[0].trial)
    if len(groups) > 1:
        axes.legend(fontsize=SMALL, loc="center right", frameon=True, framealpha=0.8, edgecolor="none")
    return curves


def _parts(curve: Curve, settings: Experiment) -> list[slice]:
    """The batches of each phase."""
    ends = np.searchsorted(curve.edges, np.cumsum(settings.phase_trials)).tolist()
    return [slice(begin, end) for begin, end in zip([0, *ends], ends, strict=False)]


def _draw_bands(axes: "Axes", settings: Experiment, trial: int) -> None:
    """A band from where each phase begins to where it ends, with its number and what is new in it."""
    humans = list(dict.fromkeys(phase.met for phase in settings.phases))
    width = (PAGE - SIDES) / settings.n_trials
    begins = 0
    places = settings.changes_of_place
    for number, (phase, place, trials) in enumerate(zip(settings.phases, places, settings.phase_trials, strict=True)):
        tint = TINTS[(humans.index(phase.met) if len(humans) > 1 else number) % len(TINTS)]
        band = axes.axvspan(begins * trial, (begins + trials) * trial, color=tint, lw=0, zorder=0)
        band.set_gid(f"phase/{number}")
        axes.axvline(begins * trial, color=GREY, linewidth=0.5 if number else 0.0, zorder=1)
        words = next(
            (each for each in _labels(number, phase, place) if width_of(each, FONT_SIZE) <= width * trials), ""
        )
        middle = ((begins + trials / 2) * trial, 1.02)
        axes.text(*middle, words, transform=axes.get_xaxis_transform(), ha="center", va="bottom", color=INK)
        begins += trials


def _labels(number: int, phase: Phase, place: str) -> list[str]:
    """What a band is called, the longest first."""
    planning = [] if phase.plan_every is None else [f"plans every {phase.plan_every:,}"]
    shorter: tuple[list[str], ...] = (
        [phase.met, place, *planning],
        [phase.met, place],
        [place] if place else [phase.met],
        [],
    )
    told = (", ".join(filter(None, each)) for each in shorter)
    whole, *others = (f"{number}: {each}" if each else str(number) for each in told)
    return [f"phase {whole}", whole, *others]
