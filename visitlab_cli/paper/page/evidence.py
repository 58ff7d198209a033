"""What the page tells of: a run compared with the published curves, and the variants that were, or were not, run."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.paper.figures.source import Source, open_source
from visitlab_cli.paper.judging.comparison import Compared
from visitlab_cli.paper.judging.variants import Variant, changes
from visitlab_cli.paper.published.counterparts import COUNTERPARTS, Absent, OurCurve, counterparts, curve_of_group
from visitlab_cli.paper.published.curves import PublishedCurve
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.facts import seconds_of

SHIPPED = "paper/variants/"


class Progress(NamedTuple):
    """How much of a run is done; `seconds` of computing as far as `timing.json` tells."""

    done: int
    cells: int
    steps: int
    seconds: float


class Choice(NamedTuple):
    """A shipped variant: what it sets otherwise for each published curve that it decides, and its run if there is one.

    `changes` is keyed by figure and condition; of a variant that was run they are its own. `crossed` is whether it
    visits with all pairs of models and seeds.
    """

    name: str
    changes: dict[tuple[str, str], list[str]]
    crossed: bool
    variant: Variant | None
    progress: Progress | None

    @property
    def complete(self) -> bool:
        """Whether all of it was run."""
        return self.progress is not None and self.progress.done == self.progress.cells

    def curve(self, published: PublishedCurve) -> OurCurve | None:
        """Its counterpart of a published curve, as far as it is run."""
        if self.variant is None:
            return None
        group = COUNTERPARTS[published.figure, published.condition]
        found = curve_of_group(self.variant.run, self.variant.cells, group, published)
        return None if isinstance(found, Absent) else found


@dataclass(frozen=True)
class Evidence:
    """All that the page is written from."""

    source: Source
    cells: Sequence[Cell]
    compared: Compared
    margin: float
    choices: Sequence[Choice]

    @property
    def run(self) -> Path:
        """The run's folder."""
        return self.source.run

    def choices_of(self, figure: str) -> list[Choice]:
        """The variants that decide some curve of a published figure otherwise."""
        return [choice for choice in self.choices if any(of == figure for of, _ in choice.changes)]


def gather(
    run: Path, cells: Sequence[Cell], compared: Compared, margin: float, variants: Sequence[Variant]
) -> Evidence:
    """The evidence on a run.

    Args:
        run: the run's folder.
        cells: its plan.
        compared: the comparison of its curves with the published.
        margin: how far, in reward a trial, counted as the same.
        variants: the runs among which each shipped variant is looked for, by the name of its config.
    """
    choices = [
        _choice(name.removeprefix(SHIPPED), file, cells, variants)
        for name, file in shipped_configs().items()
        if name.startswith(SHIPPED)
    ]
    return Evidence(open_source(run), cells, compared, margin, [choice for choice in choices if choice.changes])


def progress_of(run: Path, cells: Sequence[Cell]) -> Progress:
    """What of a plan is done."""
    done = [cell for cell in cells if read_cell(run / cell.path) is not None]
    seconds = sum(seconds_of(run / cell.path) or 0.0 for cell in done)
    return Progress(len(done), len(cells), sum(cell.steps for cell in done), seconds)


def _choice(name: str, file: Path, cells: Sequence[Cell], variants: Sequence[Variant]) -> Choice:
    config = load(file)
    planned, run_hash = plan(config), config_hash(config)
    called_so = [variant for variant in variants if variant.cells and variant.cells[0].config.name == config.name]
    exact = [variant for variant in called_so if variant.cells[0].run_hash == run_hash]
    variant = next(iter([*exact, *called_so]), None)
    others = variant.cells if variant else planned
    crossed = any(cell.settings.crossed for cell in others)
    return Choice(
        name, _changes(cells, others), crossed, variant, progress_of(variant.run, variant.cells) if variant else None
    )


def _changes(cells: Sequence[Cell], others: Sequence[Cell]) -> dict[tuple[str, str], list[str]]:
    theirs = {cell.group: cell for cell in reversed(others)}
    found = {}
    for key, ours in counterparts(cells).items():
        other = theirs.get(COUNTERPARTS[key])
        if not ours.unlike and other is not None and (changed := changes(ours.cell, other)):
            found[key] = changed
    return found
