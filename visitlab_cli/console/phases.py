"""The table of what came of each phase, for `runs show` and `compare --by phase`."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from visitlab_cli.console.unread import tell_unread
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.results.estimates import Estimate
    from visitlab_cli.results.phases import PhaseResult

PHASE = "phase"
"""What `compare --by` is given for it."""


def tell_phases(folder: Path, first: int, as_json: bool) -> None:
    """Print what came of each phase of a run."""
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.results.phases import check_any, phase_results
    from visitlab_cli.storage.run_folder import read_config

    cells = plan(read_config(folder))
    found = phase_results(folder, cells, first)
    check_any(folder, cells, found)
    tell_unread(folder, cells)
    if as_json:
        told = {"run": str(folder), "by": PHASE, "first": first, "confidence": 0.95}
        tell_json({**told, "phases": [each.as_json() for each in found]})
    else:
        tell_text("\n".join(table_and_notes(found, first)))


def table_and_notes(found: "Sequence[PhaseResult]", first: int) -> list[str]:
    """A line for each phase, and how it is to be read."""
    from visitlab_cli.results.varying import varying

    who = ["experiment", "agent"]
    new = ["new place"] if any(each.place for each in found) else []
    rest = ["phase", "human", *new, "trials"]
    numbers = [f"first {first}", "rest", "change", "met again", "n"]
    varied = varying((each.group.point for each in found), taken=[*who, *rest, *numbers])
    words = [*who, *varied.heads.values(), *rest]
    rows = [
        [
            *(each.group.experiment, each.group.agent, *varied.values(each.group.point)),
            *(str(each.phase), each.human or "-", *([each.place or "-"] if new else [])),
            f"{each.begins} to {each.begins + each.trials - 1}",
            *(_words(each.first), _words(each.rest), _words(each.change, "+"), _words(each.again, "+")),
            each.units.words if each.units.shared else str(each.units.n),
        ]
        for each in found
    ]
    return [
        aligned([[*words, *numbers], *rows], words=len(words)),
        "",
        f"Reward (goals in a visit) a trial of a phase's first {first} trials and of the rest ± half its 95% interval.",
        f"Change: its first {first} less the rest of the phase before. Met again: the first trials with a human of an",
        "earlier phase less as many of the first meeting. Both are paired: of the same robots. Phases, trials: from 0.",
    ]


def _words(estimate: "Estimate | None", sign: str = "") -> str:
    return "-" if estimate is None else estimate.in_words(sign)
