"""Fig. 7 in numbers: the jump at every third distance."""

from visitlab_cli.config.experiment import lab_of
from visitlab_cli.exact.navigation import navigation_optimal_q
from visitlab_cli.paper.figures.fig7 import EXPERIMENT, LEARNERS, gamma_of, ratios
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.paper.page.words import table
from visitlab_cli.world.enums import MAX_SPEED

SHOWN = 12
"""Distances that the paper shows."""


def jump_table(evidence: Evidence) -> str:
    """Learned over optimal value where whole moves at full speed lead to the goal room, and elsewhere; else empty."""
    rows = []
    for agent, name in LEARNERS.items():
        group = evidence.source.groups.get(f"{EXPERIMENT}/{agent}")
        if group is None:
            continue
        lab = lab_of(group.cells[0].settings)
        found = ratios(group.tables(), navigation_optimal_q(gamma_of(group), lab), lab)
        shown = found.distance <= SHOWN
        whole = found.distance % MAX_SPEED == 0
        means = [found.mean[shown & chosen].mean() for chosen in (whole, ~whole)]
        rows.append([f"model-free, {name}", str(len(group.cells)), *(f"{mean:.2f}" for mean in means)])
    header = ["learner", "n", f"distances 3, 6, .. {SHOWN}", "the others up to there"]
    return table(header, rows) if rows else ""
