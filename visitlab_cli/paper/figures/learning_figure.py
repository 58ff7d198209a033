"""Fig. 6 and Fig. 8: panels of learning curves side by side, one key below them."""

from collections.abc import Sequence

from visitlab_cli.paper.figures.designs import FIG_6, FIG_8, Design
from visitlab_cli.paper.figures.learning import panel_of, shown_in, unlike_in
from visitlab_cli.paper.figures.panel import draw_key, draw_panel
from visitlab_cli.paper.figures.source import Source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import PAGE

COLUMNS = 2
PANEL_HEIGHT, KEY_HEIGHT = 2.5, 0.5  # inches


def draw_fig6(source: Source) -> Drawing:
    """Learning of the three modules, and after watching another agent."""
    return draw_learning(source, FIG_6)


def draw_fig8(source: Source) -> Drawing:
    """Three humans, and adapting to another human in the visit."""
    return draw_learning(source, FIG_8)


def draw_visit(source: Source) -> Drawing:
    """Adapting to another human alone, the right of Fig. 8; beside the published curves though it is a variant."""
    return draw_learning(source, FIG_8[1:], even_so=True)


def draw_learning(source: Source, designs: Sequence[Design], *, even_so: bool = False) -> Drawing:
    """Those panels that the run has anything for; `even_so` as `panel_of`."""
    panels = [panel for design in designs if (panel := panel_of(source, design, even_so=even_so)) is not None]
    missing = [name for design in designs for name in _missing(source, design)]
    notes = [f"without {', '.join(dict.fromkeys(missing))}: not in this run"] if missing else []
    notes += [f"{design.title}: {unlike}" for design in designs if (unlike := unlike_in(source, design))]
    shortfall = source.shortfall([each.group.name for design in designs for each in shown_in(source, design)])
    if shortfall:
        notes.append(shortfall)
    if not panels:
        return Drawing(None, notes)
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    columns = min(COLUMNS, len(panels))
    rows = -(-len(panels) // columns)
    figure = Figure(
        figsize=(PAGE, rows * PANEL_HEIGHT + KEY_HEIGHT), layout=ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05)
    )
    grid = figure.subplots(rows, columns, squeeze=False)
    for axes in grid.flat[len(panels) :]:
        axes.set_axis_off()
    for axes, panel in zip(grid.flat, panels, strict=False):
        draw_panel(axes, panel)
    draw_key(figure, panels)
    return Drawing(figure, notes)


def _missing(source: Source, design: Design) -> list[str]:
    found = source.counterparts
    return [name for condition, name in design.named() if (design.published, condition.published) not in found]
