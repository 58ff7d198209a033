"""Names and numbers as the page writes them, and Markdown tables."""

import math
from collections.abc import Sequence

from visitlab_cli.paper.judging.judge import Judgement, Verdict
from visitlab_cli.results.estimates import Estimate

FIGURES = {
    "fig6_navigation": "Fig. 6 top left, navigation",
    "fig6_go_to_human": "Fig. 6 top right, go to human",
    "fig6_social": "Fig. 6 bottom left, social",
    "fig6_mb_mf": "Fig. 6 bottom right, after watching",
    "fig8_humans": "Fig. 8 left, three humans",
    "fig8_adaptation": "Fig. 8 right, visit the lab",
}
CONDITIONS = {
    "rmax": "R-max",
    "epsilon_greedy_mb": "model-based",
    "epsilon_greedy_mf": "model-free",
    "mf_bootstrapped": "bootstrapped",
    "human_1": "Human 1",
    "human_2": "Human 2",
    "human_3": "Human 3",
    "human_2_pointing": "Human 2 with pointing",
}
MARKS = {Verdict.AGREES: "✓", Verdict.UNDECIDED: "?", Verdict.DIFFERS: "✗"}
NOT_RUN = "not run"


def curve_name(figure: str, condition: str) -> str:
    """A published curve: 'Fig. 8 right, visit the lab: Human 1'."""
    return f"{FIGURES[figure]}: {CONDITIONS[condition]}"


def part_name(part: str) -> str:
    """A part of a curve: 'last tenth'."""
    return part.replace("_", " ")


def difference(found: Judgement) -> str:
    """Ours less the published with its interval: '+0.09 ± 0.31'."""
    return _with_half(found.difference, found.high - found.difference)


def marked(found: Judgement) -> str:
    """`difference` with the verdict's mark."""
    return f"{difference(found)} {MARKS[found.verdict]}"


def estimate(found: Estimate) -> str:
    """A change with its interval; of one seed there is none."""
    return _with_half(found.mean, found.half)


def _with_half(value: float, half: float) -> str:
    return f"{value:+.2f} (one seed)" if math.isnan(half) else f"{value:+.2f} ± {half:.2f}"


def changed(changes: Sequence[str]) -> str:
    """What a variant sets, as code: '`visit.planner_rewards: restart`'."""
    return ", ".join(f"`{change.partition(' (not ')[0]}`" for change in changes)


def table(header: Sequence[str], rows: Sequence[Sequence[str]], words: int = 1) -> str:
    """A Markdown table; the first `words` columns are words, the others are aligned to the right."""
    rule = ["---" if column < words else "---:" for column in range(len(header))]
    return "\n".join("| " + " | ".join(row) + " |" for row in [header, rule, *rows])


def listed(words: Sequence[str]) -> str:
    """Words with commas and an 'and'."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}" if words else "none"
