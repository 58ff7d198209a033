"""Spreads that the published mean and band do not show: between seeds, between models, between visits."""

from statistics import median

from visitlab_cli.paper.figures.designs import FIG_8
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.paper.judging.comparison import LAST, Comparison, part_slices
from visitlab_cli.paper.page.choices import VISIT
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.paper.page.words import CONDITIONS, NOT_RUN, curve_name, table
from visitlab_cli.results.curves import SETTLED, Spread, spread_of
from visitlab_cli.results.intervals import deviation

RISEN = 1.0
"""Reward a trial: a seed above it leads the human in some trials."""


def last_tenths(curve: Comparison) -> list[float]:
    """What each independent seed reached in the last tenth of a curve."""
    place = part_slices(len(curve.published.mean))[LAST]
    return [float(value) for value in curve.ours.curve.samples[:, place].mean(axis=1)]


def seed_table(evidence: Evidence) -> str:
    """How far the seeds of each curve lie apart, beside the published band."""
    rows, told = [], set()
    for curve in evidence.compared.curves:
        if curve.ours.group in told:
            continue
        told.add(curve.ours.group)
        reached = last_tenths(curve)
        place = part_slices(len(curve.published.mean))[LAST]
        numbers = min(reached), curve.parts[LAST].ours, max(reached), deviation(reached)
        name = curve_name(curve.published.figure, curve.published.condition)
        band = f"{curve.published.band[place].mean():.2f}"
        rows.append([name, str(len(reached)), *("-" if each != each else f"{each:.2f}" for each in numbers), band])
    return table(["curve", "n", "lowest", "mean", "highest", "deviation", "published band"], rows)


def seed_spreads(evidence: Evidence) -> str:
    """Which seeds lie furthest apart."""
    widest = max(evidence.compared.curves, key=lambda curve: max(last_tenths(curve)) - min(last_tenths(curve)))
    reached = last_tenths(widest)
    name = curve_name(widest.published.figure, widest.published.condition)
    return (
        "**Seeds lie further apart than a mean shows**, furthest in "
        f"{name}: from {min(reached):.2f} to {max(reached):.2f} in the last tenth. The published band is the deviation "
        "of single trials, mostly the luck of a trial; an interval of the mean is made of the deviation of seeds."
    )


def risen_seeds(evidence: Evidence) -> str:
    """How many seeds of the model-free agent alone learn the social task at all; empty where it was not run."""
    for curve in evidence.compared.curves:
        if (curve.published.figure, curve.published.condition) == ("fig6_social", "epsilon_greedy_mf"):
            reached = last_tenths(curve)
            risen = sum(value > RISEN for value in reached)
            last = curve.parts[LAST]
            return (
                f"**The model-free agent alone, in the social task: {risen} of {len(reached)} seeds rise** above "
                f"{RISEN:g} reward a trial in the last tenth. The mean over seeds, {last.ours:.2f} (published "
                f"{last.published:.2f}), hides that they lie from {min(reached):.2f} to {max(reached):.2f}, the median "
                f"at {median(reached):.2f}."
            )
    return ""


def crossed_table(evidence: Evidence) -> str:
    """Model variance against evaluation variance, from each run with crossed models."""
    rows = [[f"`{run}`", human, *_spreads(found)] for run, human, found in _crossed(evidence)]
    header = ["run", "human", "between models", "between visits of one model"]
    note = (
        f"Standard deviations of the mean goals a trial in the last 1/{SETTLED} of the trials, the visits' chance "
        "taken off that between models; of so few models the estimate is rough."
    )
    return f"{table(header, rows, words=2)}\n\n{note}" if rows else "No variant crosses models."


def one_model_luck(evidence: Evidence) -> str:
    """Fig. 8 right, were its ten seeds counted as the one model that they rest on; empty without it."""
    counted = [each for each in evidence.compared.curves if each.one_model]
    if not counted:
        return ""
    said = [f"{CONDITIONS[each.published.condition]} {each.one_model[LAST].verdict}" for each in counted]
    between = [found.models for _, _, found in _crossed(evidence) if found is not None]
    luck = (
        f" In the crossed runs the models' deviation is {min(between):.2f} to {max(between):.2f} goals a trial: by "
        f"that alone one model may well be off by twice as much."
        if between
        else ""
    )
    return (
        "**One model's luck.** The ten seeds of the published visits share one trained model. Counted as that one, "
        f"its last tenth against ours: {', '.join(said)}.{luck}"
    )


def _crossed(evidence: Evidence) -> list[tuple[str, str, Spread | None]]:
    """Run, human and spreads, None where they were not run; the run with the fewest changes first."""
    rows = []
    choices = [choice for choice in evidence.choices_of(VISIT) if choice.crossed]
    for choice in sorted(choices, key=lambda choice: max(map(len, choice.changes.values()))):
        groups = open_source(choice.variant.run).groups if choice.variant else {}
        for condition, group in FIG_8[1].named():
            if (VISIT, condition.published) in choice.changes:
                found = spread_of(groups[group].run, groups[group].cells) if group in groups else None
                rows.append((choice.name, CONDITIONS[condition.published], found))
    return rows


def _spreads(found: Spread | None) -> list[str]:
    return [f"{found.models:.2f}", f"{found.visits:.2f}"] if found else [NOT_RUN] * 2
