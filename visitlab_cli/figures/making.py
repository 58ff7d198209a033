"""All figures of a run as files in its folder."""

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from visitlab_cli.config.figure import FigureSettings
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.figures.curves_figure import draw_curves
from visitlab_cli.figures.doors_figure import draw_doors
from visitlab_cli.figures.grid_figure import draw_grid
from visitlab_cli.figures.meetings_figure import draw_meetings
from visitlab_cli.figures.phases_figure import draw_phases
from visitlab_cli.figures.visits_figure import draw_visits
from visitlab_cli.origin import check_ours
from visitlab_cli.paper.figures.fig7 import draw_fig7
from visitlab_cli.paper.figures.fig9 import Strip, draw_fig9
from visitlab_cli.paper.figures.learning_figure import draw_fig6, draw_fig8
from visitlab_cli.paper.figures.source import Source, open_source
from visitlab_cli.pictures.drawing import Drawing
from visitlab_cli.pictures.style import FORMATS, PAGE, STRIP_STYLE, STYLE, save, styled
from visitlab_cli.pictures.words import height_of, in_lines
from visitlab_cli.storage.inside import check_inside
from visitlab_cli.storage.locks import being_written
from visitlab_cli.storage.on_disk import FIGURES

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIG_9, CURVES, DOORS, GRID, MEETINGS, PHASES, VISITS = "fig9", "curves", "doors", "grid", "meetings", "phases", "visits"
DRAW: dict[str, Callable[[Source], Drawing]] = {
    "fig6": draw_fig6,
    "fig7": draw_fig7,
    "fig8": draw_fig8,
    CURVES: draw_curves,
    DOORS: draw_doors,
    GRID: draw_grid,
    MEETINGS: draw_meetings,
    PHASES: draw_phases,
    VISITS: draw_visits,
}
NAMES = (*(name for name in DRAW if name.startswith("fig")), FIG_9, *(name for name in DRAW if name[:3] != "fig"))
"""All figures, also Fig. 9, which is drawn by whoever can draw a strip."""
ASKED = (CURVES, MEETINGS)
"""Those that are drawn only where the config's `figure` or the user asks for them: most say what others say, too."""
QUESTION_SIZE, GAP, LEFT = 9.5, 0.06, 0.1  # points; inches below the question, and left of it
NEEDS = {
    CURVES: "several agents of a training, or visits of a human, without phases, as in configs/beyond/planners.yaml",
    DOORS: "a training of navigation with recorded steps, a phase of which has a lab with other doors than the one "
    "before, as in configs/beyond/doors.yaml",
    GRID: "vary in the config",
    MEETINGS: "phases in which a human comes again, as in configs/beyond/friends.yaml",
    PHASES: "an experiment with phases",
    VISITS: "several visits without phases, as in configs/beyond/labs.yaml",
}
"""What a figure that is not one of the paper needs of a run."""


class Made(NamedTuple):
    """The files that were written, and by figure what the reader should know of it, also why there is none."""

    files: list[Path]
    notes: dict[str, list[str]]


def make_figures(
    run: Path, strip: Strip, only: Sequence[str] = (), kind: str = "svg", into: Path | None = None
) -> Made:
    """Draw the figure that the config asks for, or all that the run has the data for; the same bytes for the same run.

    Args:
        run: the run's folder.
        strip: draws a trial of a log as a strip, for Fig. 9.
        only: names of figures; none for the config's own, or where it has none for all.
        kind: svg, png or pdf.
        into: the folder for them, made where it is missing; `RUN/figures/` if not given.

    Raises:
        UsageError: no such figure or format, or what lies in the place of one is not visitlab's.
        NotFoundError: this is no run, or it holds nothing that was asked for.
        RunError: the run is damaged, or a file cannot be written.
    """
    if kind not in FORMATS:
        raise UsageError(f"--format {kind}: must be {', '.join(FORMATS)}")
    for name in only:
        if name not in NAMES:
            raise UsageError(f"--only {name}: no such figure; there are {', '.join(NAMES)}")
    source = open_source(run)
    with being_written(run) if into is None else nullcontext():
        names = _names(source.config.figure, only)
        if into is None:
            for name in names:
                check_inside(run, run / FIGURES / f"{name}.{kind}")
        made = _make(source, strip, names, kind, into or run / FIGURES)
    if not made.files:
        needs = [f"{name} needs {need}" for name, need in NEEDS.items() if name in made.notes]
        needs += ["configs/paper/ has what each of the paper's needs"] if made.notes.keys() - NEEDS else []
        raise NotFoundError("; ".join([f"{run}: holds nothing for {', '.join(made.notes)}", *needs]))
    return made


def _names(told: FigureSettings | None, only: Sequence[str]) -> list[str]:
    """What is drawn."""
    if not only and told is not None:
        return [told.draws]
    return [name for name in NAMES if name in (only or {*NAMES} - {*ASKED})]


def _make(source: Source, strip: Strip, names: Sequence[str], kind: str, into: Path) -> Made:
    made = Made([], {})
    for name in names:
        check_ours(into / f"{name}.{kind}")  # all of them before one is drawn
    for name in names:
        with styled(STRIP_STYLE if name == FIG_9 else STYLE):
            drawing = _draw(source, name, strip)
            told = source.config.figure
            own = told is not None and told.draws == name
            made.notes[name] = [*drawing.notes, *(_unknown(source) if own else [])]
            if drawing.figure is not None:
                if told is not None and own:
                    _ask(drawing.figure, told.question)
                target = into / f"{name}.{kind}"
                save(drawing.figure, target)
                made.files.append(target)
    return made


def _draw(source: Source, name: str, strip: Strip) -> Drawing:
    return draw_fig9(source, strip) if name == FIG_9 else DRAW[name](source)


def _ask(figure: "Figure", question: str) -> None:
    """Put the question above a figure, which grows by that."""
    words = in_lines(question, PAGE - 2 * LEFT, QUESTION_SIZE, "bold")
    figure.set_figheight(figure.get_figheight() + height_of(words, QUESTION_SIZE) + GAP)
    figure.suptitle(words, x=LEFT / PAGE, ha="left", fontsize=QUESTION_SIZE, weight="bold")


def _unknown(source: Source) -> list[str]:
    """A line about names in the config's `figure` that nobody has."""
    config = source.config
    assert config.figure is not None
    wrong = [name for _, name in config.figure.unknown({*config.experiments, *config.agents, *config.humans})]
    return [f"figure: no experiment, agent or human is called {', '.join(dict.fromkeys(wrong))}"] if wrong else []
