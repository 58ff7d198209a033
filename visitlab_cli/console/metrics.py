"""The metrics of interactions as a table: what `visitlab metrics` and `runs show --metrics` print."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain

if TYPE_CHECKING:
    from visitlab_cli.results.metrics import GroupMetrics


def metrics_table(found: "Sequence[GroupMetrics]") -> str:
    """A line for each group, of a run or of an evaluation, part of it where it has phases, and metric."""
    from visitlab_cli.results.metrics import METRICS, WHOLE
    from visitlab_cli.results.varying import varying

    evaluated = any(each.group.evaluation.folder for each in found)
    phased = any(each.part != WHOLE for each in found)
    who = ["experiment", "agent", *(["phase", "trials"] if phased else []), "human"]
    rest = [*(["played"] if evaluated else []), "metric", "unit"]
    varied = varying((each.group.point for each in found), taken=[*who, *rest])
    table = [[*who, *varied.heads.values(), *rest, "mean", "n"]]
    for each in found:
        group = each.group
        part = ["-" if value in (None, "") else str(value) for value in each.part] if phased else []
        names = [group.experiment, group.agent, *part, each.human, *varied.values(group.point)]
        names += [group.evaluation.words if group.evaluation.folder else "-"] if evaluated else []
        for name, (estimate, units) in each.values.items():
            number = units.words if units.shared else str(units.n)
            table.append([*names, name, METRICS[name].unit, estimate.in_words(), number])
    return aligned([list(map(plain, row)) for row in table], words=len(table[0]) - 2)
