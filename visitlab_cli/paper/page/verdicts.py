"""The page's verdicts: the table, what agrees, what does not and why."""

from visitlab_cli.paper.judging.comparison import LAST, Comparison
from visitlab_cli.paper.judging.judge import Judgement, Verdict
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.paper.page.words import changed, curve_name, difference, listed, marked, part_name, table


def summary(evidence: Evidence) -> str:
    """How many agree, in a sentence."""
    verdicts = [each.verdict for each in evidence.compared.curves]
    counts = [f"{verdicts.count(verdict)} {word}" for verdict, word in _SAID.items() if verdict in verdicts]
    again = len(verdicts) - len({each.published.mean.tobytes() for each in evidence.compared.curves})
    repeated = f" ({again} of them drawn in two figures)" if again else ""
    last = [each.parts[LAST].verdict for each in evidence.compared.curves]
    settled = [f"{last.count(verdict)} {word}" for verdict, word in _SAID.items() if verdict in last]
    unlike = sum(ours.unlike for _, ours in evidence.compared.absent)
    absent = f"; {len(evidence.compared.absent) - unlike} more were not run" if evidence.compared.absent else ""
    absent += f", {unlike} not as published" if unlike else ""
    return (
        f"Of {len(verdicts)} published curves{repeated} {listed(counts)}{absent}; in the last tenth alone "
        f"{listed(settled)}. A curve agrees where the 95% interval of the difference lies within "
        f"{evidence.margin:g} reward a trial in all four parts of it, it differs where in some part the interval lies "
        "wholly beyond, else it is undecided. The interval counts the ten seeds of the published run as well: their "
        "deviation is not known, ours stands for it."
    )


_SAID = {Verdict.AGREES: "agree", Verdict.UNDECIDED: "are undecided", Verdict.DIFFERS: "differ"}


def verdict_table(evidence: Evidence) -> str:
    """Each curve in four parts."""
    curves = evidence.compared.curves
    header = ["curve", "verdict", "n", *(part_name(part) for part in curves[0].parts)]
    rows = [
        [
            curve_name(each.published.figure, each.published.condition),
            str(each.verdict),
            str(each.ours.curve.counted.n),
            *(marked(part) for part in each.parts.values()),
        ]
        for each in curves
    ]
    return "\n".join(
        [
            table(header, rows, words=2),
            "",
            "Ours less the published, reward (in the visit: goals) a trial. ✓ agrees, ? undecided, ✗ differs; "
            "n: independent seeds, in a visit trained models.",
        ]
    )


def not_judged(evidence: Evidence) -> str:
    """The curves that can't be judged, as something that decides them is not as published; empty where all can."""
    found = [(published, ours) for published, ours in evidence.compared.absent if ours.unlike]
    lines = [f"- {curve_name(published.figure, published.condition)}: {ours.reason}" for published, ours in found]
    return "\n".join(["Not judged:", "", *lines]) if lines else ""


def agreeing(evidence: Evidence) -> str:
    """The curves that agree."""
    names = [_name(each) for each in evidence.compared.curves if each.verdict == Verdict.AGREES]
    return "\n".join(f"- {name}" for name in names) or "No curve agrees in all four parts."


def disagreeing(evidence: Evidence) -> str:
    """For each other curve its parts: what makes them agree, or what would decide."""
    lines = []
    for each in evidence.compared.curves:
        if each.verdict == Verdict.AGREES:
            continue
        lines.append(f"- **{_name(each)}** {_SAID_OF_ONE[each.verdict]}.")
        lines += [f"  - {line}" for line in [*_differing(evidence, each), *_undecided(each)]]
    return "\n".join(lines) or "No curve differs or is undecided."


_SAID_OF_ONE = {Verdict.UNDECIDED: "is undecided", Verdict.DIFFERS: "differs"}


def _name(each: Comparison) -> str:
    return curve_name(each.published.figure, each.published.condition)


def _differing(evidence: Evidence, each: Comparison) -> list[str]:
    return [
        f"{part_name(part)} {difference(found)}, differs: {_why(evidence, each, part)}"
        for part, found in each.parts.items()
        if found.verdict == Verdict.DIFFERS
    ]


def _undecided(each: Comparison) -> list[str]:
    """The undecided parts, those of the same reason in one line."""
    reasons: dict[str, list[str]] = {}
    for part, found in each.parts.items():
        if found.verdict == Verdict.UNDECIDED:
            reasons.setdefault(_what_decides(found), []).append(f"{part_name(part)} {difference(found)}")
    return [f"{listed(parts)}, undecided: {reason}" for reason, parts in reasons.items()]


def _what_decides(found: Judgement) -> str:
    if found.seeds < 2:
        return "one seed has no interval."
    if found.seeds_that_decide is None:
        return "no number of seeds of ours would decide, the published ten alone leave it open."
    return f"{found.seeds_that_decide} seeds would decide, if mean and deviation stay."


def _why(evidence: Evidence, each: Comparison, part: str) -> str:
    """The simplest variants in which the part agrees; else the nearest, and what was not tried."""
    agreeing = sorted(
        (tried for tried in each.tried if tried.explains(part)),
        key=lambda tried: len(tried.changes),
    )
    if agreeing:
        first = agreeing[0]
        changes = ("these together: " if len(first.changes) > 1 else "") + changed(first.changes)
        return f"it agrees ({difference(first.parts[part])}) with {changes} (run {first.name})."
    choices = evidence.choices_of(each.published.figure)
    missing = [choice.name for choice in choices if not choice.complete]
    if missing:
        said = f"not explained by what was run; {listed(missing)} was not run to the end."
    elif choices:
        said = f"unexplained: every variant of the figure ({len(choices)}) was run, none makes it agree."
    else:
        said = "unexplained: the figure has no variant."
    if not each.tried:
        return said
    nearest = min(each.tried, key=lambda tried: abs(tried.parts[part].difference))
    left = nearest.parts[part]
    decides = f"; {_what_decides(left)}" if left.verdict == Verdict.UNDECIDED else "."
    where = f"{changed(nearest.changes)}: {difference(left)} (run {nearest.name})"
    return f"{said} Nearest is {where}, {left.verdict}{decides}"
