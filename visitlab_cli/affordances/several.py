"""What each model of an agent of several believes: what is general, what is specific, and whose each model is.

An agent that meets several humans and makes itself a model for each kind of them has, in the end, several learned
Fig. 4. Its general model is all of them as one, each with its say. An arrow of Fig. 4 that each model affords is
general; one that some afford and others do not, or that differs, is specific to a human. Whose a model is, the agent
does not know: it is the human who was there in more than half of the steps that the model counts, several humans'
where nobody was.
"""

import math
from collections.abc import Mapping, Sequence
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.affordances.counts import KINDS, Kind, Levels, learned_counts
from visitlab_cli.affordances.learned import Graph, graph
from visitlab_cli.affordances.plain import ARROWS, OUTCOMES, Arrow, transitions, weight
from visitlab_cli.affordances.truth import FIRST_ENGAGED, Truth, true_transitions, undecided
from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.sparse_model import MOST_OF_ONE, pooled_models
from visitlab_cli.errors import NotFoundError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import model_of
from visitlab_cli.plan.selection import Selection
from visitlab_cli.results.own_models import counting_models, humans_there
from visitlab_cli.results.trained import trained_with
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.world.columns import MODELS
from visitlab_cli.world.geometry import CLOSEST_APPROPRIATE, FARTHEST_APPROPRIATE

ENOUGH = 10
"""Times that a model must have tried it, to be asked."""
AFFORDS = 0.05
"""A model affords what it believes to be likelier."""
SURE = 2.576
"""Standard deviations: an interval of 99%, since many are compared."""
COMPARED = tuple(arrow for arrow in ARROWS if arrow.kind is not Kind.GO_TO_HUMAN_VISION)
"""The arrows that are compared: 'go to human vision' is another action in a visit than in training."""


class Verdict(StrEnum):
    """What an arrow is, over all models that tried it `ENOUGH`, as far as intervals of 99% tell."""

    GENERAL = "general"
    """Each affords it, and no two differ."""
    DEGREE = "general, by degree"
    """Each affords it, and some two differ."""
    SPECIFIC = "specific"
    """Some two differ, and not each affords it."""
    NONE = "none"
    """None affords it."""
    OPEN = "open"
    """Nobody can tell, or fewer than two tried it often enough."""


class Belief(NamedTuple):
    """What a model believes of an arrow: the times it tried it, the probability, its interval, and what is true.

    Of what depends on the human's engagement, only where the distance is appropriate: elsewhere all fails with all.
    `true` is the probability with the human whose model it is; nan where nobody knows.
    """

    visits: int
    probability: float
    low: float
    high: float
    true: float


class OfModel(NamedTuple):
    """A model: its number, whose it is ('' for several humans'), how many steps with each human it counts, Fig. 4.

    `trained` is what it counted before the visit; `graph` is of all distances, `compared` counts as the beliefs do.
    """

    number: int
    human: str
    trained: int
    steps: dict[str, int]
    graph: Graph
    compared: Graph
    beliefs: dict[Arrow, Belief]


class Several(NamedTuple):
    """A visit's agent of several models: each that counts anything, all as one, and what each arrow is.

    `general` is of all distances, `compared` counts as the beliefs do.
    """

    cell: Cell
    models: list[OfModel]
    general: Graph
    compared: Graph
    shared: dict[Arrow, Belief]
    verdicts: dict[Arrow, Verdict]


def several_models(run: Path, cells: Sequence[Cell], selection: Selection) -> Several:
    """What the models of the first chosen visit, whose agent has several and which is finished, believe.

    Raises:
        NotFoundError: there is none.
        RunError: its file is damaged.
    """
    chosen = [cell for cell in selection.of(run, cells) if MODELS in cell.parts]
    for cell in chosen:
        if read_cell(run / cell.path) is not None:
            return of_saved(cell, model_of(run, cell))
    if chosen:
        raise NotFoundError(f"{run}: {chosen[0].path} is not finished")
    known = dict.fromkeys(cell.experiment for cell in cells if MODELS in cell.parts)
    raise NotFoundError(
        f"{run}: no visit of an agent of several models"
        + (f" among these; there is {', '.join(known)}" if known else "")
    )


def of_saved(cell: Cell, saved: Saved) -> Several:
    """The same of what a cell's agent saved."""
    by_name = cell.player.models(saved)
    kept = {int(name.split()[-1]): model for name, model in by_name.items() if model["visits"].any()}
    truths = {human: _truth(cell, human) for human in cell.humans}
    models = [_of_model(cell, saved, number, kept[number], truths) for number in sorted(kept)]
    together = learned_counts(pooled_models(list(kept.values()), float(MOST_OF_ONE * len(kept))))
    compared = _compared(together, undecided())
    return Several(
        cell,
        models,
        graph(together, undecided()),
        compared,
        _beliefs(compared),
        {arrow: verdict([model.beliefs[arrow] for model in models]) for arrow in COMPARED},
    )


def _of_model(cell: Cell, saved: Saved, number: int, model: Saved, truths: Mapping[str, Truth]) -> OfModel:
    there = humans_there(cell)[counting_models(saved, cell.steps) == number]
    steps = {human: int((there == human).sum()) for human in cell.humans}
    trained = max(0, round(float(model["visits"].sum())) - len(there))
    human = _whose(steps, trained, _trained_with(cell))
    counts, truth = learned_counts(model), truths.get(human) or _truth(cell, human)
    compared = _compared(counts, truth)
    return OfModel(number, human, trained, steps, graph(counts, truth), compared, _beliefs(compared))


def _trained_with(cell: Cell) -> str:
    """The one human whom what the visit began with had met; '' where they are several."""
    humans = trained_with(cell)
    return humans.pop() if len(humans) == 1 else ""


def _whose(steps: Mapping[str, int], trained: int, trained_with: str) -> str:
    """The human of more than half of the steps that a model counts, training's among them; '' where there is none."""
    met = dict(steps)
    met[trained_with] = met.get(trained_with, 0) + trained
    return next((human for human, n in met.items() if 2 * n > sum(met.values())), "")


def _truth(cell: Cell, human: str) -> Truth:
    if not human or cell.settings.hidden:
        return undecided()
    return true_transitions(cell.config.humans[human], False, cell.config.interaction.distances)


def _compared(counts: Levels, truth: Truth) -> Graph:
    """The graph of all distances, but of what depends on the human's engagement only of those that are right."""
    near = np.zeros_like(counts)
    right = slice(CLOSEST_APPROPRIATE, FARTHEST_APPROPRIATE + 1)
    near[:, :, right] = counts[:, :, right]
    depends = np.zeros(counts.shape[:2], dtype=bool)
    for arrow in COMPARED:
        depends[KINDS.index(arrow.kind), arrow.level] |= arrow.outcome >= FIRST_ENGAGED
    return graph(np.where(depends[:, :, None, None], near, counts), truth)


def _beliefs(compared: Graph) -> dict[Arrow, Belief]:
    return {arrow: _belief(compared, arrow) for arrow in COMPARED}


def _belief(found: Graph, arrow: Arrow) -> Belief:
    told = weight(found, arrow)
    if not told.visits:
        return Belief(0, math.nan, 0.0, 1.0, math.nan)
    return Belief(told.visits, told.learned, *_interval(told.learned, told.visits), (told.low + told.high) / 2)


def _interval(share: float, n: float) -> tuple[float, float]:
    """Wilson's interval of a share of n."""
    spread = SURE**2 / n
    middle = (share + spread / 2) / (1 + spread)
    half = SURE * math.sqrt(share * (1 - share) / n + spread / (4 * n)) / (1 + spread)
    return max(0.0, middle - half), min(1.0, middle + half)


def verdict(beliefs: Sequence[Belief]) -> Verdict:
    """What an arrow is of which several models believe this."""
    tried = [each for each in beliefs if each.visits >= ENOUGH]
    if len(tried) < 2:
        return Verdict.OPEN
    differ = max(each.low for each in tried) > min(each.high for each in tried)
    if all(each.low > AFFORDS for each in tried):
        return Verdict.DEGREE if differ else Verdict.GENERAL
    if all(each.high < AFFORDS for each in tried):
        return Verdict.NONE
    return Verdict.SPECIFIC if differ else Verdict.OPEN


def as_json(found: Several) -> dict[str, Any]:
    """All of it: `models` and `general` with `transitions`, and `affordances` with what each model believes."""
    return {
        "cell": found.cell.path,
        "humans": list(found.cell.humans),
        "models": [
            {
                "model": each.number,
                "human": each.human or None,
                "steps_before": each.trained,
                "steps": each.steps,
                "transitions": transitions(each.graph),
            }
            for each in found.models
        ],
        "general": {"transitions": transitions(found.general)},
        "affordances": [
            {
                "action": str(arrow.kind),
                "level": arrow.level.name,
                "level_next": OUTCOMES[arrow.outcome],
                "verdict": str(found.verdicts[arrow]),
                "general": _belief_as_json(found.shared[arrow]),
                "models": {each.number: _belief_as_json(each.beliefs[arrow]) for each in found.models},
            }
            for arrow in COMPARED
        ],
    }


def _belief_as_json(belief: Belief) -> dict[str, Any]:
    known = belief.visits > 0
    return {
        "visits": belief.visits,
        "learned": belief.probability if known else None,
        "interval": [belief.low, belief.high] if known else None,
        "true": None if math.isnan(belief.true) else belief.true,
    }
