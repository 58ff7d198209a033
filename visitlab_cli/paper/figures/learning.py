"""A panel of learning curves with the data of a run."""

from collections.abc import Sequence
from typing import NamedTuple

from visitlab_cli.paper.figures.designs import Condition, Design
from visitlab_cli.paper.figures.panel import CHANCE, OPTIMUM, Line, Panel, Reference
from visitlab_cli.paper.figures.source import Group, Source
from visitlab_cli.paper.published.curves import PublishedCurve, published_curves
from visitlab_cli.pictures.style import GREY
from visitlab_cli.plan.cells import Cell
from visitlab_cli.results.curves import curve_of, equal_edges, spread_of
from visitlab_cli.results.possible import possible_in

BATCHES, VISIT_BATCHES = 100, 50  # as published
SPREADS = "standard deviation in the last quarter\nbetween models, between visits"
MILLION, THOUSAND = 1_000_000, 1_000
IN_EACH_LINE = "{}"


class Shown(NamedTuple):
    """A condition, the run's group that is shown for it, and why the published curve is no measure of that."""

    condition: Condition
    group: Group
    reason: str


def shown_in(source: Source, design: Design) -> list[Shown]:
    """What a run has for the conditions of a design; of a grid of which no point is as published, nothing."""
    shown = []
    for condition in design.conditions:
        found = source.counterparts.get((design.published, condition.published))
        if found is not None and found.points == 1:
            shown.append(Shown(condition, source.groups[found.group], found.reason))
    return shown


def unlike_in(source: Source, design: Design) -> str:
    """'not as published: Human 2: human_2.p_A 0.15, published 0.05'; empty where all of a design is as published."""
    of_reason: dict[str, list[str]] = {}
    for condition in design.conditions:
        found = source.counterparts.get((design.published, condition.published))
        if found is not None and found.unlike:
            of_reason.setdefault(found.reason, []).append(condition.name)
    alone = [of_reason[reason] for reason in of_reason] == [[each.name for each in design.conditions]]
    told = [reason if alone else f"{', '.join(names)}: {reason}" for reason, names in of_reason.items()]
    return f"not as published: {'; '.join(told)}" if told else ""


def panel_of(source: Source, design: Design, *, even_so: bool = False) -> Panel | None:
    """The panel with the run's data; None where the run holds none of its curves.

    Args:
        source: the run.
        design: what the panel compares.
        even_so: whether the published curve is drawn beside one that is not as published, too.
    """
    shown = shown_in(source, design)
    if not shown:
        return None
    found = [(each.condition, each.group) for each in shown]
    cell = found[0][1].cells[0]
    settings = cell.settings
    end = settings.n_trials if settings.counted_in == "trials" else settings.n_steps
    x_unit, x_label = x_of(cell, end)
    published = {curve.condition: curve for curve in published_curves() if curve.figure == design.published}
    marks = [trial * settings.trial_steps for _, group in found if (trial := watched_trials(group))]
    spreads = [
        f"{condition.name}: {both.models:.2f}, {both.visits:.2f}"
        for condition, group in found
        if (both := spread_of(group.run, group.cells)) is not None
    ]
    return Panel(
        title=design.title,
        x_label=x_label,
        x_unit=x_unit,
        y_label=measure_of(cell),
        lines=[_line(each, published[each.condition.published], even_so=even_so) for each in shown],
        references=_references(source, design, shown),
        end=float(end),
        mark=float(marks[0]) if marks else None,
        unlike=unlike_in(source, design),
        note="\n".join([SPREADS, *spreads]) if spreads else "",
    )


def x_of(cell: Cell, end: float) -> tuple[int, str]:
    """In which unit the trials of a visit, or the steps of a training, are told up to `end`; and what they are."""
    if cell.settings.counted_in == "trials":
        return 1, "trial"
    return (MILLION, "step of training (millions)") if end >= MILLION else (THOUSAND, "step of training (thousands)")


def measure_of(cell: Cell) -> str:
    """What a learning curve shows."""
    measure = "goal rooms in a trial" if cell.settings.plays.counts_goals else "reward of a trial"
    return f"{measure} of {cell.settings.trial_steps} steps"


def watched_trials(group: Group) -> int:
    """How many trials an observer only watched: it is seen acting from then on. 0 for other agents."""
    cell = group.cells[0]
    watched = 0 if cell.settings.assembled else cell.config.agents[cell.agent].watched_steps
    return watched // cell.settings.trial_steps if watched < cell.steps else 0


def _line(shown: Shown, published: PublishedCurve, *, even_so: bool) -> Line:
    condition, group, reason = shown
    cell = group.cells[0]
    batches = VISIT_BATCHES if cell.settings.assembled else BATCHES
    edges = equal_edges(cell.trials, batches, watched_trials(group))
    ours = curve_of(group.run, group.cells, edges)
    beside = published if even_so or not reason else None
    return Line(group.name, _name(condition, cell), condition.colour, condition.marker, ours, beside)


def _name(condition: Condition, cell: Cell) -> str:
    """What a curve is called: as published, and as the run has it where that is another name."""
    own = [name for name in (cell.agent, cell.human) if name and name not in condition.group.split("/")]
    unusual = own if not cell.settings.assembled else [name for name in own if name == cell.human]
    return f"{condition.name} ({', '.join(unusual)})" if unusual else condition.name


def _references(source: Source, design: Design, shown: Sequence[Shown]) -> list[Reference]:
    """The exact values where they are known, else the means of the run's own reference groups.

    An optimum that is not the same for all has a line for each; chance, which hardly differs, has that of the first.
    """
    first = shown[0].group.cells[0]
    exact = [(known, each.condition.colour) for each in shown if (known := possible_in(each.group.cells[0]))]
    if len(exact) == len(shown):
        best = [(known.optimum, colour) for known, colour in exact]
        alike = len({value for value, _ in best}) == 1
        lines = [Reference(OPTIMUM, best[0][0])] if alike else [Reference(OPTIMUM, *each) for each in best]
        return [*lines, Reference(CHANCE, exact[0][0].random)]
    found = []
    for kind, group in design.references:
        if IN_EACH_LINE in group:
            cells = [(each.group.cells[0], each.condition.colour) for each in shown]
            named = [(group.replace(IN_EACH_LINE, cell.human), cell, colour) for cell, colour in cells]
        else:
            named = [(group, first, GREY)]
        values = [(source.reference(name, cell), colour) for name, cell, colour in named]
        found += [Reference(kind, value, colour) for value, colour in values if value is not None]
    return found
