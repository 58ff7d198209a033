"""The page's text: its sections in their order."""

from collections.abc import Iterator, Mapping

from visitlab_cli.origin import MARKDOWN
from visitlab_cli.paper.page.choices import VISIT, other_choices, visit_distances, visit_effects
from visitlab_cli.paper.page.evidence import Evidence
from visitlab_cli.paper.page.observation import jump_table
from visitlab_cli.paper.page.possible import beaten_by_script, possible_table
from visitlab_cli.paper.page.runs import commands, run_table, unfinished_line, version_line
from visitlab_cli.paper.page.spreads import crossed_table, one_model_luck, risen_seeds, seed_spreads, seed_table
from visitlab_cli.paper.page.verdicts import agreeing, disagreeing, not_judged, summary, verdict_table

CAPTIONS = {
    "fig6": "Fig. 6. Learning of the three modules, and after watching another agent.",
    "fig7": "Fig. 7. What the model-free agent learns of navigation, alone and from watching.",
    "fig8": "Fig. 8. Three humans, and the visit as this run's config has it.",
    "fig8_best_match": "Fig. 8 right with the best match found (`fig8_best_match`).",
    "fig9": "Fig. 9. An interaction with Human 2.",
    "grid": "What the run varies: the level against each setting, and the learning curves of its values.",
    "affordances": "Fig. 4 as the social module of seed 0 learned it, what it would do around the human, and how both "
    "change in a visit (`visitlab affordances`).",
}
"""Of each picture, in their order."""


def page(evidence: Evidence, pictures: Mapping[str, str], file: str) -> str:
    """The whole page.

    Args:
        evidence: what it tells of.
        pictures: their addresses from the page, by name.
        file: the page's own.
    """
    return "\n\n".join(part for part in _parts(evidence, pictures, file) if part) + "\n"


def _parts(evidence: Evidence, pictures: Mapping[str, str], file: str) -> Iterator[str]:
    yield f"{MARKDOWN}compare {evidence.run.name} --page {file}`; every number is read from runs -->"
    yield "# The paper, reproduced and judged"
    yield summary(evidence)
    yield "## What was run"
    yield run_table(evidence)
    yield (
        "A run's name ends in the hash of its config. The time is the sum of its cells' `timing.json`, one core each; "
        f"compilation and figures are not in it. Versions: {version_line(evidence)}."
    )
    if unfinished := unfinished_line(evidence):
        yield unfinished
    yield "## The figures"
    yield from (f"![{name}]({pictures[name]})\n\n*{caption}*" for name, caption in CAPTIONS.items() if name in pictures)
    yield "## Verdicts"
    yield verdict_table(evidence)
    yield not_judged(evidence)
    yield "## What agrees"
    yield agreeing(evidence)
    yield "## What does not, and why"
    yield (
        "A cause is named only where a run that changes it makes the part agree, and no other part of its curve "
        "differs; 'unexplained' stands only where every "
        "variant of the figure was run and none does. Of so many variants and parts some may agree by chance."
    )
    yield disagreeing(evidence)
    yield from _visit(evidence)
    yield "## Other choices, one at a time"
    yield "Reward a trial in this run → with the choice; published: first tenth, last tenth."
    yield other_choices(evidence)
    yield "## How much of the possible"
    yield "Last tenth, reward a trial; shares of what the best known has over random actions."
    yield possible_table(evidence)
    yield from _unseen(evidence)
    yield "## How to repeat it"
    yield f"```\n{commands(evidence, file)}\n```"


def _visit(evidence: Evidence) -> Iterator[str]:
    if not any(each.published.figure == VISIT for each in evidence.compared.curves):
        return
    yield "## Fig. 8 right: what each choice moves"
    yield (
        "Goals a trial with the choice less those of this run, 95% intervals, the same seeds in pairs. With "
        "`models: first` all visits share one model: there is one independent seed and no interval."
    )
    yield visit_effects(evidence)
    yield (
        "How far each of these runs is from the published curves, ours less the published; in the last column how many "
        "of the curves' four parts agree, are undecided, differ:"
    )
    yield visit_distances(evidence)
    yield "### Model or chance"
    yield crossed_table(evidence)


def _unseen(evidence: Evidence) -> Iterator[str]:
    yield "## What the paper could not see"
    yield risen_seeds(evidence)
    yield beaten_by_script(evidence)
    yield one_model_luck(evidence)
    if jumps := jump_table(evidence):
        yield (
            "**The jump of Fig. 7 in numbers.** Learned over optimal value where the distance to the goal room is one "
            "of whole moves at full speed, and elsewhere:"
        )
        yield jumps
    yield seed_spreads(evidence)
    yield seed_table(evidence)
