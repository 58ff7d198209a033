"""A panel of learning curves with the data of a run."""

from visitlab_cli.agents.observer import ObserverParameters
from visitlab_cli.analysis.exact_values import possible
from visitlab_cli.analysis.published_curves import PublishedCurve, published_curves
from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.experiments import Visit
from visitlab_cli.figures.designs import Condition, Design
from visitlab_cli.figures.panel import CHANCE, OPTIMUM, Line, Panel, Reference
from visitlab_cli.figures.source import Group, Source
from visitlab_cli.pictures.style import GREY
from visitlab_cli.results.curves import curve_of, equal_edges, spread_of

BATCHES, VISIT_BATCHES = 100, 50  # as published
SPREADS = "standard deviation in the last quarter\nbetween models, between visits"
MILLION, THOUSAND = 1_000_000, 1_000
IN_EACH_LINE = "{}"


def panel_of(source: Source, design: Design) -> Panel | None:
    """The panel with the run's data; None where the run holds none of its curves."""
    found = [(condition, source.groups[name]) for condition, name in design.named() if name in source.groups]
    settings = source.config.experiments.get(design.experiment)
    if settings is None or not found:
        return None
    visit = isinstance(settings, Visit)
    end = settings.trials if isinstance(settings, Visit) else settings.steps
    x_unit = 1 if visit else MILLION if end >= MILLION else THOUSAND
    x_label = {1: "trial", THOUSAND: "step of training (thousands)", MILLION: "step of training (millions)"}[x_unit]
    measure = "goal rooms in a trial" if visit else "reward of a trial"
    published = {curve.condition: curve for curve in published_curves() if curve.figure == design.published}
    marks = [trial * settings.trial_steps for _, group in found if (trial := watched_trials(source, group))]
    spreads = [
        f"{condition.name}: {both.models:.2f}, {both.visits:.2f}"
        for condition, group in found
        if (both := spread_of(group.run, group.cells)) is not None
    ]
    return Panel(
        title=design.title,
        x_label=x_label,
        x_unit=x_unit,
        y_label=f"{measure} of {settings.trial_steps} steps",
        lines=[_line(source, condition, group, published[condition.published]) for condition, group in found],
        references=_references(source, design, settings),
        end=float(end),
        mark=float(marks[0]) if marks else None,
        note="\n".join([SPREADS, *spreads]) if spreads else "",
    )


def watched_trials(source: Source, group: Group) -> int:
    """How many trials an observer only watched: it is seen acting from then on. 0 for other agents."""
    cell = group.cells[0]
    parameters = source.config.agents.get(cell.agent)
    if not isinstance(parameters, ObserverParameters) or isinstance(cell.settings, Visit):
        return 0
    return parameters.until // cell.settings.trial_steps if parameters.until < cell.steps else 0


def _line(source: Source, condition: Condition, group: Group, published: PublishedCurve) -> Line:
    cell = group.cells[0]
    batches = VISIT_BATCHES if isinstance(cell.settings, Visit) else BATCHES
    edges = equal_edges(cell.trials, batches, watched_trials(source, group))
    ours = curve_of(group.run, group.cells, edges)
    return Line(group.name, condition.name, condition.colour, condition.marker, ours, published)


def _references(source: Source, design: Design, settings: Experiment) -> list[Reference]:
    """The exact values where they are known, else the means of the run's own reference groups."""
    exact = possible(settings, source.config.interaction.distances)
    if exact is not None:
        return [Reference(OPTIMUM, exact.optimum), Reference(CHANCE, exact.random)]
    found = []
    for kind, group in design.references:
        if IN_EACH_LINE in group:
            last = [(condition.group.split("/")[-1], condition.colour) for condition in design.conditions]
            named = [(group.replace(IN_EACH_LINE, name), colour) for name, colour in last]
        else:
            named = [(group, GREY)]
        found += [
            Reference(kind, float(source.groups[name].rewards().mean()), colour)
            for name, colour in named
            if name in source.groups
        ]
    return found
