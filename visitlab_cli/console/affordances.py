"""The tables of `visitlab affordances`: what a module believes, what several models do, what is left with intents."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from visitlab_cli.console.words import aligned

if TYPE_CHECKING:
    from visitlab_cli.affordances.learned import Affordances, Graph
    from visitlab_cli.affordances.plain import Weight
    from visitlab_cli.affordances.restricted import PairSet, Restricted
    from visitlab_cli.affordances.several import Belief, Several
    from visitlab_cli.plan.cells import Cell


def text(found: "Affordances", cells: "Sequence[Cell]") -> str:
    """What the module believes, before and after its visits, and what else there is of it."""
    return "\n".join([*_lines(found), *_see_also(found, cells)])


def _lines(found: "Affordances") -> list[str]:
    learned = f"as it begins: {', '.join(found.pool)} as one" if found.pool else f"learned with {found.learned_with}"
    lines = [f"{found.cell.path}, {learned}", _table({"learned": found.knows}), ""]
    for each in found.adaptations:
        lines += [
            f"{each.cell.path}, after its visit to {each.cell.human}",
            _table({"before": found.knows, "after": each.knows, "in the visit": each.saw}),
            "",
        ]
    lines += [
        "Probability of the level next (visits behind it). True: by the human's parameters, at the visits in the",
        "column before; - where they alone do not decide it. NOT_ENGAGED: any of the levels 0 to 4.",
    ]
    return lines


def _see_also(found: "Affordances", cells: "Sequence[Cell]") -> list[str]:
    """What else there is of the same module."""
    from visitlab_cli.affordances.learned import pool_of
    from visitlab_cli.world.columns import MODELS

    several = [cell.group for cell in cells if MODELS in cell.parts and cell.agent == found.cell.agent]
    pooled = [cell for cell in cells if found.cell.path in pool_of(cell)]
    lines = [f"With --models: each of its models in {several[0]}."] if several else []
    if pooled:
        more = f"of {len(pool_of(pooled[0]))} that {pooled[0].group} begins with as one"
        lines.append(f"It is one {more}: --experiment {pooled[0].experiment} shows that.")
    return lines


def _table(graphs: "dict[str, Graph]") -> str:
    from visitlab_cli.affordances.plain import ARROWS, OUTCOMES, weight

    rows = [["action", "level", "level next", *graphs, "true"]]
    for arrow in ARROWS:
        weights = [weight(graph, arrow) for graph in graphs.values()]
        learned = [f"{each.learned:.3f} ({each.visits:,})" if each.visits else "-" for each in weights]
        rows.append([str(arrow.kind), arrow.level.name, OUTCOMES[arrow.outcome], *learned, _true(weights[-1])])
    return aligned(rows, words=3)


def _true(weight: "Weight") -> str:
    if math.isnan(weight.low):
        return "-"
    low, high = f"{weight.low:.3f}", f"{weight.high:.3f}"
    return low if low == high else f"{low} to {high}"


def models_text(found: "Several") -> str:
    """Whose each model is, and what each believes."""
    from visitlab_cli.affordances.plain import OUTCOMES
    from visitlab_cli.affordances.several import AFFORDS, COMPARED, ENOUGH

    whose = [["steps counted", "whose", "before", *found.cell.humans]]
    whose += [
        [f"model {each.number}", each.human or "several", f"{each.trained:,}", *(f"{n:,}" for n in each.steps.values())]
        for each in found.models
    ]
    rows = [["action", "level", "level next", "", "general", *(f"model {each.number}" for each in found.models)]]
    for arrow in COMPARED:
        beliefs = [found.shared[arrow], *(each.beliefs[arrow] for each in found.models)]
        words = [str(arrow.kind), arrow.level.name, OUTCOMES[arrow.outcome], str(found.verdicts[arrow])]
        rows.append([*words, *map(_belief, beliefs)])
    return "\n".join(
        [
            found.cell.path,
            aligned(whose, words=2),
            "",
            aligned(rows, words=4),
            "",
            "Probability of the level next that a model believes (true with the human whose it is, who was there in",
            "more than half of the steps that it counts). NOT_ENGAGED: any of the levels 0 to 4. What depends on",
            f"engagement is told where the distance is right. Of models that tried it {ENOUGH} times: general: each",
            f"affords it, with more than {AFFORDS:g}; by degree: and two differ; specific: two differ, and not each",
            "affords it; none: none does; open: nobody can tell. As far as 99% intervals tell. Not compared:",
            "go_to_human_vision, which teleports in training and walks in a visit.",
        ]
    )


def _belief(belief: "Belief") -> str:
    if not belief.visits:
        return "-"
    return f"{belief.probability:.3f}" + ("" if math.isnan(belief.true) else f" ({belief.true:.3f})")


def intents_text(found: "Sequence[Restricted]", trials: int) -> str:
    """How many pairs afford each intent, and what is left of the reward with these alone."""
    lines = []
    for each in found:
        n = len(each.seeds)
        lines += [f"{each.group}, {n} seed{'' if n == 1 else 's'}", _intents_table(each), ""]
    lines += [
        "Pairs of state and action: how many afford each intent with probability k, how many are planned with (of a",
        "state without any, all that were tried), and how many (state, action, next state) a sweep goes through.",
        f"Reward a trial in {trials:,} trials, greedy, without learning; kept, and the difference by seed, against all",
        "pairs that were tried. Means over seeds, 95% intervals. own: by the agent's own values.",
    ]
    return "\n".join(lines)


def _intents_table(module: "Restricted") -> str:
    from visitlab_cli.affordances.intents import INTENTS
    from visitlab_cli.results.estimates import mean_of

    rows = [["pairs", *INTENTS, "planned with", "entries", "reward", "kept", "difference"]]
    rows.append(["own", *["-"] * (len(INTENTS) + 2), mean_of(list(module.own)).in_words(), "-", "-"])
    rows += [_intents_row(module, each) for each in module.sets]
    return aligned(rows, words=1)


def _intents_row(module: "Restricted", found: "PairSet") -> list[str]:
    from visitlab_cli.results.estimates import mean_of

    affording = ["-" if found.threshold is None else f"{each:,.0f}" for each in found.affording.mean(axis=0)]
    sizes = [f"{each.mean():,.0f}" for each in (found.pairs, found.entries)]
    reward, kept = mean_of(list(found.reward)).in_words(), module.kept(found)
    against = ["-", "-"] if found is module.whole else [_percent(kept), module.difference(found).in_words("+")]
    return [found.name, *affording, *sizes, reward, *against]


def _percent(share: float) -> str:
    return "-" if math.isnan(share) else f"{share:.0%}"
