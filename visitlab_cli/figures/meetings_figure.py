"""The figure of meetings: what is reached with a human who is new, and with one who was met before."""

from visitlab_cli.config.figure import NO_FIGURE
from visitlab_cli.figures.bars import Bar, Panel, draw_bars
from visitlab_cli.figures.visits_figure import controller_of
from visitlab_cli.paper.figures.source import Group, Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import PAGE, SMALL
from visitlab_cli.pictures.words import in_lines
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.results.phases import FIRST, meetings
from visitlab_cli.results.units import Units, by_unit

PARTS = {
    "first_new": f"new: first {FIRST} trials",
    "rest_new": "new: the rest",
    "first_again": f"met again: first {FIRST}",
    "rest_again": "met again: the rest",
}
EDGE = 0.1  # inches
NOTE = "the first phase does not count; lines: 95% interval of the mean (Student's t)"


def draw_meetings(source: Source) -> Drawing:
    """Bars for what has phases in which a human comes again: visits, or where there are none trainings."""
    several = [group for group in source.groups.values() if group.cells[0].settings.phases]
    visits = [group for group in several if group.cells[0].settings.assembled]
    parts: dict[str, dict[str, Bar]] = {title: {} for title in PARTS.values()}
    rows = {}
    known: dict[str, list[str]] = {}
    for group in visits or several:
        units = Units(len(by_unit(group.cells)), len(group.cells))
        found = meetings(group.run, group.cells)
        if found is not None and found.met_again:
            rows[group.name] = group
            if found.known:
                known.setdefault(f"{found.known} of the {found.new} new humans", []).append(_called(source, group))
            for part, values in found._asdict().items():
                if part in PARTS and len(values):
                    parts[PARTS[part]][group.name] = Bar(mean_of(values.tolist()), units)
    if not rows:
        return Drawing(None)
    measure = "goals a trial" if visits else "reward a trial"
    panels = [Panel(title, measure, bars) for title, bars in parts.items() if bars]
    called = {name: _called(source, group) for name, group in rows.items()}
    kinds = {name: controller_of(group) for name, group in rows.items()}
    lines = [NOTE, *(f"trained with {of_new}: {'; '.join(names)}" for of_new, names in known.items())]
    note = "\n".join(in_lines(line, PAGE - 2 * EDGE, SMALL) for line in lines)
    return Drawing(draw_bars(called, panels, note, kinds, shared=True))


def _called(source: Source, group: Group) -> str:
    words = (source.config.figure or NO_FIGURE).words
    cell = group.cells[0]
    settings = cell.settings
    return words(cell.experiment) if settings.assembled and not cell.point else group.name
