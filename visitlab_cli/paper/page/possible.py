"""How much of the possible was reached: beside the exact optimum, in a visit a script that is told the rules."""

from typing import NamedTuple

from visitlab_cli.paper.figures.designs import FIG_6, FIG_8, Design
from visitlab_cli.paper.figures.panel import CHANCE, MEANINGS, OPTIMUM, SCRIPT
from visitlab_cli.paper.figures.source import Source
from visitlab_cli.paper.judging.comparison import LAST, Comparison
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.paper.page.words import curve_name, table
from visitlab_cli.plan.cells import Cell


class Yardstick(NamedTuple):
    """Reward a trial of the best that is known, what that is, and of random actions."""

    kind: str
    best: float
    random: float

    def share(self, value: float) -> float:
        """0 as random, 1 as the best."""
        return (value - self.random) / (self.best - self.random)


def yardstick(source: Source, curve: Comparison) -> Yardstick | None:
    """What a curve is measured by; None where the run has no script or no random actions for it."""
    if curve.possible:
        return Yardstick(OPTIMUM, curve.possible.optimum, curve.possible.random)
    return _script(source, curve)


def _script(source: Source, curve: Comparison) -> Yardstick | None:
    """The run's script beside a curve; None where it has none, or no random actions."""
    (design,) = [design for design in (*FIG_6, *FIG_8) if design.published == curve.published.figure]
    if not any(kind == SCRIPT for kind, _ in design.references):
        return None
    best, random = (_reference(source, design, kind, curve.ours.cell) for kind in (SCRIPT, CHANCE))
    return None if best is None or random is None else Yardstick(SCRIPT, best, random)


def possible_table(evidence: Evidence) -> str:
    """Each curve's last tenth as a share of what the best known has over random actions."""
    rows, told = [], set()
    for curve in evidence.compared.curves:
        measure = yardstick(evidence.source, curve)
        if measure is None or curve.ours.group in told:
            continue
        told.add(curve.ours.group)
        last = curve.parts[LAST]
        name = curve_name(curve.published.figure, curve.published.condition)
        values = measure.random, last.ours, last.published, measure.best
        shares = [f"{measure.share(value):.0%}" for value in (last.ours, last.published)]
        rows.append([name, *(f"{value:.2f}" for value in values), MEANINGS[measure.kind], *shares])
    if not rows:
        return "The run has no references to measure by."
    header = ["curve", "random", "ours", "published", "best known", "which is", "ours, share", "published, share"]
    return table(header, rows)


def beaten_by_script(evidence: Evidence) -> str:
    """How many curves a script without any learning is above; empty where none was run."""
    found = [(_script(evidence.source, curve), curve) for curve in evidence.compared.curves]
    scripted = {curve.ours.group: (script, curve) for script, curve in found if script}
    if not scripted:
        return ""
    above = [script.share(curve.parts[LAST].ours) for script, curve in scripted.values()]
    below = sum(share < 1 for share in above)
    return (
        f"**A script is better than {below} of {len(above)} learned behaviours.** Approach, hello, come, point if "
        f"needed, lead: it is told the rules and learns nothing. What was learned has, in the last tenth, "
        f"{min(above):.0%} to {max(above):.0%} of what the script has over random actions."
    )


def _reference(source: Source, design: Design, kind: str, cell: Cell) -> float | None:
    """The mean reward of a reference group; where chance is kept for one human alone, it stands for all."""
    names = [group.replace("{}", cell.human) for of_kind, group in design.references if of_kind == kind]
    names = [f"{name.rsplit('/', 1)[0]}/{cell.human}" for name in names] + names
    return next((found for name in names if (found := source.reference(name, cell)) is not None), None)
