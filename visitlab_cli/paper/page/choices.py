"""What single choices move: every variant of a curve beside the run itself."""

from collections.abc import Iterator, Sequence

from visitlab_cli.paper.judging.comparison import FIRST, LAST, Comparison, judge_parts, part_slices
from visitlab_cli.paper.judging.judge import Judgement, Verdict, worst
from visitlab_cli.paper.page.evidence import Choice, Evidence
from visitlab_cli.paper.page.words import (
    CONDITIONS,
    MARKS,
    NOT_RUN,
    changed,
    curve_name,
    estimate,
    marked,
    part_name,
    table,
)
from visitlab_cli.results.curves import Curve
from visitlab_cli.results.estimates import Estimate, difference_of, mean_of

VISIT = "fig8_adaptation"
SHOWN = FIRST, LAST


def effect(evidence: Evidence, ours: Comparison, choice: Choice, part: str) -> Estimate | None:
    """What a choice moves a part of a curve by, seeds paired where the same seed means the same luck."""
    theirs = choice.curve(ours.published)
    if theirs is None or choice.variant is None:
        return None
    place = part_slices(len(ours.published.mean))[part]
    before, after = (_of_units(curve.curve, place) for curve in (ours.ours, theirs))
    same_luck = ours.ours.cell.config.seed == theirs.cell.config.seed
    common = [unit for unit in before if unit in after] if same_luck else []
    if common:
        return mean_of([after[unit] - before[unit] for unit in common])
    return difference_of([*before.values()], [*after.values()])


def visit_effects(evidence: Evidence) -> str:
    """Fig. 8 right: what each choice moves, in the first and the last tenth of the trials."""
    rows = []
    curves = _visits(evidence)
    for choice in _in_order(evidence):
        found = [effect(evidence, curve, choice, part) for curve in curves for part in SHOWN]
        rows.append([_set(choice), *(estimate(each) if each else NOT_RUN for each in found)])
    return table(["choice", *_columns(curves)], rows)


def visit_distances(evidence: Evidence) -> str:
    """Fig. 8 right: how far from the published curves each choice is; how many of all parts have which verdict."""
    curves = _visits(evidence)
    rows = [_distances(f"`{evidence.run.name}`", [curve.parts for curve in curves])]
    for choice in _in_order(evidence):
        rows.append(_distances(f"`{choice.name}`", [judged(evidence, curve, choice) for curve in curves]))
    return table(["run", *_columns(curves), " / ".join(MARKS[verdict] for verdict in Verdict)], rows)


def _distances(name: str, curves: Sequence[dict[str, Judgement] | None]) -> list[str]:
    shown = [marked(parts[part]) if parts else NOT_RUN for parts in curves for part in SHOWN]
    verdicts = [part.verdict for parts in curves if parts for part in parts.values()]
    counts = " / ".join(str(verdicts.count(verdict)) for verdict in Verdict)
    return [name, *shown, counts if verdicts else NOT_RUN]


def judged(evidence: Evidence, ours: Comparison, choice: Choice) -> dict[str, Judgement] | None:
    """The parts of a variant's curve against the published one."""
    theirs = choice.curve(ours.published)
    return judge_parts(theirs.curve, ours.published.mean, evidence.margin) if theirs else None


def other_choices(evidence: Evidence) -> str:
    """All curves but those of the visit: what they were, what they become with each choice."""
    rows = list(_other_rows(evidence))
    if not rows:
        return "The run has no curve that a variant decides otherwise."
    return table(["curve", "choice", "first tenth", "last tenth", "published", "verdict with it"], rows, words=2)


def _other_rows(evidence: Evidence) -> Iterator[list[str]]:
    told = set()
    for ours in evidence.compared.curves:
        key = ours.published.figure, ours.published.condition
        for choice in evidence.choices:
            if ours.published.figure == VISIT or key not in choice.changes or (ours.ours.group, choice.name) in told:
                continue
            told.add((ours.ours.group, choice.name))
            parts = judged(evidence, ours, choice)
            moved = [f"{ours.parts[part].ours:.2f} → {parts[part].ours:.2f}" if parts else NOT_RUN for part in SHOWN]
            published = ", ".join(f"{ours.parts[part].published:.2f}" for part in SHOWN)
            verdict = str(worst([part.verdict for part in parts.values()])) if parts else NOT_RUN
            yield [curve_name(*key), changed(choice.changes[key]), *moved, published, verdict]


def _of_units(curve: Curve, place: slice) -> dict[str, float]:
    """What each independent unit reached in a part of the curve."""
    return dict(zip(curve.units, curve.samples[:, place].mean(axis=1).tolist(), strict=True))


def _visits(evidence: Evidence) -> list[Comparison]:
    return [each for each in evidence.compared.curves if each.published.figure == VISIT]


def _columns(curves: list[Comparison]) -> list[str]:
    return [f"{CONDITIONS[each.published.condition]}, {part_name(part)}" for each in curves for part in SHOWN]


def _in_order(evidence: Evidence) -> list[Choice]:
    """The variants of Fig. 8 right, single choices first; those that only cross models have a table of their own."""
    found = [choice for choice in evidence.choices_of(VISIT) if not choice.crossed]
    return sorted(found, key=lambda choice: len(_of_visit(choice)))


def _of_visit(choice: Choice) -> list[str]:
    return next(changes for (figure, _), changes in choice.changes.items() if figure == VISIT)


def _set(choice: Choice) -> str:
    return f"`{choice.name}`: {changed(_of_visit(choice))}"
