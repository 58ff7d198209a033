"""The page itself, `docs/reproduction.md`, and its pictures."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from visitlab_cli.affordances.learned import affordances
from visitlab_cli.affordances.picture import save_affordances
from visitlab_cli.errors import NotFoundError, UsageError
from visitlab_cli.origin import check_ours
from visitlab_cli.paper.figures.learning_figure import draw_visit
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.paper.page import text
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.pictures.style import STYLE, save, styled, write

IMAGES = "images/reproduction"
KIND = "svg"
BEST_MATCH = "fig8_best_match"
AFFORDANCES = "affordances"
DrawFigures = Callable[[Path, str, Path], Iterable[Path]]
"""Draws the figures of a run, in a format, into a folder."""


def write_page(evidence: Evidence, page: Path, draw: DrawFigures) -> list[Path]:
    """Write the page and, in `images/reproduction` beside it, the pictures that the run has data for.

    Args:
        evidence: what it tells of.
        page: its file, ending in .md.
        draw: draws the figures of a run into a folder, as `KIND`.

    Raises:
        UsageError: another ending, or what lies in the place of a file is not visitlab's.
        RunError: a run is damaged, or a file cannot be written.
    """
    if page.suffix != ".md":
        raise UsageError(f"--page {page}: must end in .md")
    check_ours(page)
    pictures = list(_pictures(evidence, page.parent / IMAGES, draw))
    content = text.page(evidence, {file.stem: f"{IMAGES}/{file.name}" for file in pictures}, page.as_posix())
    write(page, content.encode())
    return [page, *pictures]


def _pictures(evidence: Evidence, folder: Path, draw: DrawFigures) -> Iterator[Path]:
    """The paper's figures, the visit of the best match, what the module of the visits believes."""
    with suppress(NotFoundError):  # where the run holds no figure's data
        yield from draw(evidence.run, KIND, folder)
    for choice in evidence.choices:
        if choice.name == BEST_MATCH and choice.variant is not None:
            with styled(STYLE):
                figure = draw_visit(open_source(choice.variant.run)).figure
                if figure is not None:
                    save(figure, folder / f"{BEST_MATCH}.{KIND}")
                    yield folder / f"{BEST_MATCH}.{KIND}"
    with suppress(NotFoundError):  # where no module learns a model of the human
        save_affordances(affordances(evidence.run, evidence.cells), folder / f"{AFFORDANCES}.{KIND}")
        yield folder / f"{AFFORDANCES}.{KIND}"
