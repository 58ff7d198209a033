"""Every trained human against every human: the visits of such a matrix, and the goals that they reached.

A row is a human that the visit's social module was trained with, a column one that it then leads; each pair is
played frozen (no learning, no exploration) and adapting (it goes on learning), with the visit's own navigation and
go_to_human modules. This is the question of the paper's sections 2.3 and 5.3.
"""

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.evaluation import AS_DECLARED, Evaluation
from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import unit_values
from visitlab_cli.results.units import Units, in_words
from visitlab_cli.storage.cell_folder import read_cell
from visitlab_cli.storage.run_folder import read_config
from visitlab_cli.world.tasks import SOCIAL

FROZEN, ADAPTING = "frozen", "adapting"
MODES = (FROZEN, ADAPTING)


class Pairing(NamedTuple):
    """The human trained with, the human met, and how: `frozen` or `adapting`.

    Of several trainings with one human, which a pool may have, `trained` is the training.
    """

    trained: str
    met: str
    mode: str


Planned = dict[Pairing, list[Cell]]


class Goals(NamedTuple):
    """Goals a trial, mean over independent `units`; None where no cell is done.

    Frozen, all trials are alike and count; adapting, the last tenth does. `group` is where the cells lie in the run.
    """

    value: Estimate | None
    units: Units
    group: str

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        value = self.value.as_json() if self.value else {"mean": None, "interval": None}
        return {**value, "n": self.units.n, "n_of": self.units.of, "cells": self.group}


class Matrix(NamedTuple):
    """`visit` is the experiment, `social` the `experiment/agent` of its social module.

    `pool` names the trainings that the visit itself begins with as one; none where it has no pool. No row is a pool.
    """

    visit: str
    social: str
    trials: int
    goals: dict[Pairing, Goals]
    pool: tuple[str, ...] = ()
    trainings: Mapping[str, str] = {}
    """The training of each row."""

    @property
    def trained(self) -> list[str]:
        """The rows."""
        return list(dict.fromkeys(pairing.trained for pairing in self.goals))

    @property
    def met(self) -> list[str]:
        """The columns."""
        return list(dict.fromkeys(pairing.met for pairing in self.goals))

    @property
    def n(self) -> str:
        """What its means are taken over: 'n = 10 seeds'."""
        return in_words([goals.units for goals in self.goals.values()])

    @property
    def rows(self) -> str:
        """What a row is, where the visit itself begins with a pool; else nothing."""
        if not self.pool:
            return ""
        elsewhere = [each for each in self.trainings.values() if each.rpartition("/")[0] != self.social]
        told = f"; not of {self.social}: {', '.join(elsewhere)}" if elsewhere else ""
        return f"Each row is one training alone{told}; {self.visit} itself begins with {len(self.pool)} as one."

    def as_json(self) -> dict[str, Any]:
        """Plain values."""
        return {
            "visit": self.visit,
            "social": self.social,
            "pool": list(self.pool),
            "trials": self.trials,
            "measure": {FROZEN: "goals a trial", ADAPTING: "goals a trial, last tenth"},
            "trained_with": self.trained,
            "trainings": dict(self.trainings),
            "humans": self.met,
            "goals": [
                {"trained_with": pairing.trained, "human": pairing.met, "mode": pairing.mode, **goals.as_json()}
                for pairing, goals in self.goals.items()
            ],
        }


def plan_matrix(config: Config, visit: str, humans: Sequence[str] = (), trials: int | None = None) -> Planned:
    """The visits of a matrix, which lie below `evaluations/`; those that the config itself plans, where they lie.

    Args:
        config: a config that does not vary.
        visit: the experiment whose modules and options play.
        humans: those that are met; none for all that the config declares.
        trials: of each visit; None for as many as it has.
    """
    settings = config.experiments[visit]
    own = settings.starts[SOCIAL]
    planned: Planned = {}
    trainings = _trainings(config, settings)
    alike = [training.human for training in trainings]
    for training, met, mode in product(trainings, humans or config.humans, MODES):
        social = "" if training == own and not settings.pooled else training.text
        as_declared = not social and met in settings.met and mode == ADAPTING and trials in (None, settings.n_trials)
        options = AS_DECLARED if as_declared else Evaluation((met,), trials, mode == FROZEN, social)
        cells = plan(config, options)
        trained = str(training.human) if alike.count(training.human) == 1 else training.text
        planned[Pairing(trained, met, mode)] = [c for c in cells if (c.experiment, c.human) == (visit, met)]
    return planned


def _trainings(config: Config, settings: Experiment) -> list[Module]:
    """The rows: those of the experiment and agent of the social module, and what else is in its pool."""
    own = settings.starts[SOCIAL]
    humans = config.experiments[own.experiment].met
    pool = [settings.starts[role] for role in settings.pooled]
    return list(dict.fromkeys([*(own._replace(human=human) for human in humans), *pool]))


def matrix_of(run: Path, planned: Mapping[Pairing, Sequence[Cell]]) -> Matrix:
    """What the finished cells of a plan reached.

    Raises:
        RunError: a table of trials, or the run's config, is damaged.
    """
    some = next(iter(planned.values()))[0]
    social = some.settings.starts[SOCIAL]
    goals = {pairing: _goals(run, cells) for pairing, cells in planned.items()}
    visit = read_config(run).experiments[some.experiment]
    pool = tuple(visit.starts[role].text for role in visit.pooled)
    trainings = {pairing.trained: cells[0].settings.starts[SOCIAL].text for pairing, cells in planned.items()}
    return Matrix(some.experiment, f"{social.experiment}/{social.agent}", some.trials, goals, pool, trainings)


def _goals(run: Path, cells: Sequence[Cell]) -> Goals:
    done = [cell for cell in cells if read_cell(run / cell.path) is not None]
    values = list(unit_values(run, done).values())
    return Goals(mean_of(values) if values else None, Units(len(values), len(done)), cells[0].group)
