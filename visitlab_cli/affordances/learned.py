"""What a run's social module believes: the learned Fig. 4 beside the true one, and how visits change it."""

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.affordances.counts import Levels, learned_counts
from visitlab_cli.affordances.policy import PolicyMap, policy_map
from visitlab_cli.affordances.truth import FIRST_ENGAGED, Truth, true_transitions, undecided
from visitlab_cli.errors import NotFoundError, RunError
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import models_of, modules_of, setting_of, values_of
from visitlab_cli.plan.selection import Selection
from visitlab_cli.storage.arrays import Arrays
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.world.social import Ints
from visitlab_cli.world.tasks import SOCIAL

Table = npt.NDArray[np.float64]


class Graph(NamedTuple):
    """A Fig. 4: arrays over kinds of action, levels and outcomes, as `KINDS`, `InteractionLevel` and `OUTCOMES`.

    `visits` has shape (9, 8). `learned`, shape (9, 8, 9), is the share of those visits after which each outcome
    followed; nan without visits. `low` and `high`, shape (9, 8, 9), bound the true probability, averaged over the
    distances at which these visits were; nan without visits and where the rules decide nothing.
    """

    visits: Ints
    learned: Table
    low: Table
    high: Table


class Adaptation(NamedTuple):
    """A social module after a visit: all it knows, and what it saw in the visit alone; the truth is that human's."""

    cell: Cell
    knows: Graph
    saw: Graph
    policy: PolicyMap


class Affordances(NamedTuple):
    """A trained social module, and what it became in each visit that it took part in.

    Or what the visit `cell` begins with: the trainings of its `pool`, their paths, as one; the truth is then that of
    the human who is visited.
    """

    cell: Cell
    knows: Graph
    policy: PolicyMap
    adaptations: list[Adaptation]
    pool: tuple[str, ...] = ()

    @property
    def learned_with(self) -> str:
        """The humans of its training, or that they are a pool's."""
        return "a pool" if self.pool else " and ".join(self.cell.humans)


FIRST = Selection(seed=0)


def affordances(run: Path, cells: Sequence[Cell], selection: Selection = FIRST) -> Affordances:
    """The affordances that a social module of a run has learned.

    Args:
        run: the run's folder.
        cells: all cells of its plan.
        selection: which module; or which visit, whose module it then is, its whole pool as one.

    Raises:
        NotFoundError: the run has no such module that is trained and learns a model.
        RunError: a model's file is damaged.
    """
    visits = [cell for cell in cells if cell.settings.assembled and selection.experiment and selection.matches(cell)]
    if visits and visits[0].settings.pooled:
        return _beginning(run, visits[0])
    if visits:
        module = [cell for cell in cells if cell.path == visits[0].modules[SOCIAL]]
        cells, selection = [*module, *visits], Selection()
    trained = trained_module(run, cells, selection)
    counts, policy = _read(run, trained)
    adaptations: dict[tuple[str, str], Adaptation] = {}
    for visit in _visits_of(run, cells, trained):
        if (visit.experiment, visit.human) not in adaptations:
            adaptations[visit.experiment, visit.human] = _adaptation(run, visit, counts)
    return Affordances(trained, graph(counts, _truth(trained)), policy, list(adaptations.values()))


def _beginning(run: Path, visit: Cell) -> Affordances:
    """What a visit begins with that has a pool."""
    saved = visit.settings.begun_with(visit.learner, setting_of(visit), modules_of(run, visit))
    model = next(iter(visit.learner.models(saved).values()))
    policy = policy_map(visit.learner.values(saved), model["visits"])
    return Affordances(visit, graph(learned_counts(model), _truth(visit)), policy, [], pool_of(visit))


def pool_of(visit: Cell) -> tuple[str, ...]:
    """The paths of the trainings that a visit's pool puts together; none where it has no pool."""
    return tuple(visit.modules[role] for role in visit.settings.pooled)


def _read(run: Path, cell: Cell) -> tuple[Levels, PolicyMap]:
    """What a social module has seen follow what, and what it would do."""
    model = model_acted_by(run, cell)
    return learned_counts(model), policy_map(values_of(run, cell), model["visits"])


def model_acted_by(run: Path, cell: Cell) -> Arrays:
    """The learned model of a social module, of several the one that it acts by.

    Raises:
        NotFoundError: it shows none, or its file is missing.
        RunError: its file is damaged.
    """
    for model in models_of(run, cell).values():
        return model
    raise NotFoundError(f"{run / cell.path}: {cell.agent} plans, but with no model that it would show")


def graph(counts: Levels, truth: Truth) -> Graph:
    """The learned and the true Fig. 4 of counts by kind, level, distance and next level."""
    at_distance = counts.sum(axis=3)
    visits = at_distance.sum(axis=2)
    followed = counts.sum(axis=2)
    followed = np.concatenate([followed, followed[..., :FIRST_ENGAGED].sum(axis=-1, keepdims=True)], axis=-1)
    learned = _share(followed, visits)
    low, high = (_share(_weighted(bound, at_distance), visits) for bound in truth)
    return Graph(np.rint(visits).astype(np.int64), learned, low, high)


def _weighted(bound: Table, at_distance: Levels) -> Table:
    """Bounds by distance summed with the visits there, shape (9, 8, 9); a distance never visited counts nothing."""
    weights = at_distance[..., None]
    return np.where(weights > 0, bound * weights, 0.0).sum(axis=2)  # type: ignore[no-any-return]


def _share(events: npt.NDArray[np.generic], visits: Levels) -> Table:
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(events, np.float64) / visits[..., None]


def _truth(cell: Cell) -> Truth:
    """That of the human; nothing where it met several, or where what it perceives is not how engaged they are."""
    human, *others = cell.humans
    if others or cell.settings.hidden:
        return undecided()
    teleports = not cell.settings.assembled
    return true_transitions(cell.config.humans[human], teleports, cell.config.interaction.distances)


def _adaptation(run: Path, visit: Cell, before: Levels) -> Adaptation:
    (after, policy), truth = _read(run, visit), _truth(visit)
    return Adaptation(visit, graph(after, truth), graph(after - before, truth), policy)


def trained_module(run: Path, cells: Sequence[Cell], selection: Selection) -> Cell:
    """The first module that was chosen, is trained and learns a model; one that a visit starts from before others.

    Raises:
        NotFoundError: there is none.
        RunError: there is none that is whole.
    """
    visited = {cell.modules[SOCIAL] for cell in cells if cell.settings.assembled}
    wanted = [cell for cell in cells if cell.task == SOCIAL and cell.config.agents[cell.agent].plans]
    modules = [cell for cell in wanted if read_cell(run / cell.path) is not None]
    matching = [cell for cell in modules if selection.matches(cell)]
    if not matching:
        damaged = [cell.path for cell in wanted if selection.matches(cell) and (run / cell.path).exists()]
        if damaged:
            raise RunError(f"{run / damaged[0]}: damaged; running again redoes it")
        if any(cell.settings.assembled and cell.experiment == selection.experiment for cell in cells):
            raise NotFoundError(
                f"{run}: {selection.experiment} is a visit: choose it alone or with a human and seed that it has; with "
                "--intents choose a training"
            )
        known = ", ".join(dict.fromkeys(cell.group for cell in modules))
        raise NotFoundError(
            f"{run}: no such social module that is trained and learns a model"
            + (f"; there are {known}, seeds 0 to {max(cell.seed for cell in modules)}" if known else "")
        )
    return next((cell for cell in matching if cell.path in visited), matching[0])


def _visits_of(run: Path, cells: Sequence[Cell], trained: Cell) -> list[Cell]:
    visits = [
        cell for cell in cells if cell.settings.assembled and not cell.settings.pooled and not cell.learner.forgets
    ]
    of_it = [cell for cell in visits if cell.modules[SOCIAL] == trained.path and len(cell.humans) == 1]
    return [cell for cell in of_it if read_cell(run / cell.path) is not None]
