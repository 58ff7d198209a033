"""What planning keeps of the reward where it is restricted to pairs that afford an intent, for each human of a run."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.affordances.intents import INTENTS, Mask, affording, chances, entries, planned
from visitlab_cli.affordances.learned import model_acted_by, trained_module
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.errors import NotFoundError
from visitlab_cli.execution.build import Simulation, Stretch, build
from visitlab_cli.execution.cell_runner import simulate
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import modules_of, setting_of, values_of
from visitlab_cli.plan.selection import Selection
from visitlab_cli.random_numbers import random_state
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.storage.cell_folder import read_cell

Table = npt.NDArray[np.float64]

THRESHOLDS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9)
TRIALS = 2000
"""In which a policy is played."""
OFTEN = 3
"""Pairs tried less often are dropped for comparison."""
GAMMA = 0.9
"""Of an agent that has none."""
STREAM = "intents"
ALL, MANY = "all tried", f"tried {OFTEN}+ times"


class PairSet(NamedTuple):
    """Pairs that planning is restricted to, in each of some seeds, and what it reaches, frozen and greedy.

    `threshold` is None where no intent is asked for. `affording`, shape (seeds, intents), are the pairs that afford
    each intent; `pairs`, `entries` of a sweep and `reward` a trial have shape (seeds,).
    """

    name: str
    threshold: float | None
    affording: Table
    pairs: Table
    entries: Table
    reward: Table


class Restricted(NamedTuple):
    """The modules of a group, one a seed, planned anew; `own` is the reward by their own values, shape (seeds,)."""

    group: str
    human: str
    seeds: list[int]
    own: Table
    sets: list[PairSet]

    @property
    def whole(self) -> PairSet:
        """All pairs that were ever tried."""
        return self.sets[0]

    def kept(self, found: PairSet) -> float:
        """The share of the reward with all pairs; nan where that is 0."""
        whole = float(self.whole.reward.mean())
        return float(found.reward.mean()) / whole if whole else float("nan")

    def difference(self, found: PairSet) -> Estimate:
        """Reward a trial against that with all pairs, paired by seed."""
        return mean_of(list(found.reward - self.whole.reward))


def restricted(
    run: Path,
    cells: Sequence[Cell],
    selection: Selection,
    thresholds: Sequence[float] = THRESHOLDS,
    trials: int = TRIALS,
) -> list[Restricted]:
    """Plan with some pairs alone, and play it: for each human that modules of one experiment and agent met.

    Args:
        run: the run's folder.
        cells: all cells of its plan.
        selection: which modules; of the experiment and agent whose module `trained_module` chooses.
        thresholds: each k.
        trials: of the training's task in which each policy is played.

    Raises:
        NotFoundError: there are none, they met several humans in turn, or engagement is hidden from them.
        RunError: a model's file is damaged.
    """
    first = trained_module(run, cells, selection)
    of_one = [cell for cell in cells if (cell.experiment, cell.agent) == (first.experiment, first.agent)]
    modules = [cell for cell in of_one if selection.matches(cell) and read_cell(run / cell.path) is not None]
    for cell in modules:
        _check(cell)
    groups = dict.fromkeys(cell.group for cell in modules)
    return [_group([cell for cell in modules if cell.group == group], run, thresholds, trials) for group in groups]


def _check(cell: Cell) -> None:
    if len(cell.humans) > 1:
        raise NotFoundError(f"{cell.path}: met {', '.join(cell.humans)} in turn, so there is no one task to plan for")
    if cell.settings.hidden:
        raise NotFoundError(f"{cell.path}: engagement is hidden from it, so what it perceives affords no intent")
    for path, why in cell.absent.items():
        raise NotFoundError(f"{cell.path}: can't be played: {path}: {why}")


def _group(cells: Sequence[Cell], run: Path, thresholds: Sequence[float], trials: int) -> Restricted:
    own, rows = zip(*(_module(run, cell, thresholds, trials) for cell in cells), strict=True)
    sets = [_over_seeds(of_seeds) for of_seeds in zip(*rows, strict=True)]
    return Restricted(cells[0].group, cells[0].human, [cell.seed for cell in cells], np.array(own), sets)


def _over_seeds(found: Sequence[PairSet]) -> PairSet:
    """The same set in several seeds, as arrays over these."""
    arrays: Any = {name: np.array([getattr(one, name) for one in found]) for name in PairSet._fields[2:]}
    return found[0]._replace(**arrays)


def _module(run: Path, cell: Cell, thresholds: Sequence[float], trials: int) -> tuple[float, list[PairSet]]:
    """Of one seed: the reward by its own values, and the sets, with numbers in place of arrays over seeds."""
    model = model_acted_by(run, cell)
    found, tried = chances(model), model["visits"] >= 1
    task = build(cell, modules_of(run, cell)).stretches[0].task
    gamma, symmetric = float(getattr(cell.learner, "gamma", GAMMA)), getattr(cell.learner, "symmetric", False)

    def with_pairs(name: str, threshold: float | None, allowed: Mask) -> PairSet:
        afford: Any = [np.nan if threshold is None else np.count_nonzero(each >= threshold) for each in found]
        q = planned(setting_of(cell), model, allowed, gamma, symmetric=symmetric)
        size: Any = np.count_nonzero(allowed)
        return PairSet(name, threshold, afford, size, entries(model, allowed), _reward(cell, task, q, trials))

    sets = [with_pairs(ALL, None, tried), with_pairs(MANY, None, model["visits"] >= OFTEN)]
    sets += [with_pairs(f"k {each:g}", each, affording(found, tried, each)) for each in thresholds]
    return _reward(cell, task, values_of(run, cell), trials), sets


def _reward(cell: Cell, task: Any, q: Table, trials: int) -> Any:
    """The mean reward a trial of who is greedy and learns nothing; all of a cell begin with the same random state."""
    agent = GreedyTable(np.ascontiguousarray(q, np.float64))
    played = Simulation([Stretch(task, agent, trials * cell.settings.trial_steps)], cell.player, trials, cell.settings)
    random = random_state(cell.config.seed, cell.path, STREAM)
    rewards, _ = simulate(played, random, lambda columns, rows: None, lambda steps: None)
    return float(rewards.mean())


def as_json(found: Sequence[Restricted], trials: int) -> dict[str, Any]:
    """All of it as plain values: sizes are means over seeds, `difference` is paired with all pairs, by seed."""
    return {
        "trials": trials,
        "confidence": 0.95,
        "modules": [
            {
                "module": each.group,
                "human": each.human,
                "seeds": each.seeds,
                "own_values": mean_of(list(each.own)).as_json(),
                "sets": [_set_as_json(each, pairs) for pairs in each.sets],
            }
            for each in found
        ],
    }


def _set_as_json(module: Restricted, found: PairSet) -> dict[str, Any]:
    kept = module.kept(found)
    affording = dict(zip(map(str, INTENTS), found.affording.mean(axis=0).tolist(), strict=True))
    return {
        "set": found.name,
        "threshold": found.threshold,
        "affording": None if found.threshold is None else affording,
        "pairs": float(found.pairs.mean()),
        "entries": float(found.entries.mean()),
        "reward": mean_of(list(found.reward)).as_json(),
        "kept": None if np.isnan(kept) else kept,
        "difference": module.difference(found).as_json(),
    }
