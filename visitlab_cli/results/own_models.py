"""How well an agent of several models told humans apart: its switches beside who was really there."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.model_switching import MEMORY
from visitlab_cli.plan.cells import Cell

Ints = npt.NDArray[np.int64]


class Met(NamedTuple):
    """A phase: its human, and whether at each of its steps the human's own model was active.

    A model belongs to the human with whom it was most often active, over all phases; a human's own is the one of its
    models that was most often active with it. Who shares a model with another who had it more often has none.
    """

    human: str
    own: npt.NDArray[np.bool_]

    @property
    def delay(self) -> float:
        """Steps until it is active; nan where it never is."""
        return float(np.argmax(self.own)) if self.own.any() else float("nan")


def active_models(saved: Saved, steps: int) -> Ints:
    """The model by which each step was chosen, shape (steps,): a switch holds from the next step on."""
    active = np.zeros(steps, np.int64)
    for step, _, model, _ in saved["switches"]:
        active[step:] = model
    return active


def counting_models(saved: Saved, steps: int) -> Ints:
    """The model that counts each step in the end, shape (steps,): a switch gives the new one those since the change."""
    counting = np.zeros(steps, np.int64)
    for step, _, model, since in saved["switches"]:
        counting[max(since, step - MEMORY) :] = model
    return counting


def humans_there(cell: Cell) -> npt.NDArray[np.str_]:
    """The name of the human who was there at each step of a cell, shape (steps,)."""
    if not cell.settings.phases:
        return np.full(cell.steps, cell.human)
    lengths = np.array(cell.settings.phase_trials) * cell.settings.trial_steps
    return np.repeat([phase.met for phase in cell.settings.phases], lengths)


def met(cell: Cell, saved: Saved) -> Iterator[Met]:
    """Each phase of a cell whose agent has several models, from what it saved."""
    ends = np.cumsum(cell.settings.phase_trials) * cell.settings.trial_steps
    active = np.split(active_models(saved, cell.steps), ends[:-1])
    humans = [phase.met for phase in cell.settings.phases]
    own = _own(humans, active)
    for human, models in zip(humans, active, strict=True):
        yield Met(human, models == own[human])


def _own(humans: Sequence[str], active: Sequence[Ints]) -> dict[str, int]:
    """The own model of each human, -1 for none, from who was there and which models were active, phase by phase."""
    names = list(dict.fromkeys(humans))
    steps = np.zeros((len(names), 1 + max(int(models.max()) for models in active)), np.int64)
    for human, models in zip(humans, active, strict=True):
        np.add.at(steps[names.index(human)], models, 1)
    theirs = np.where(steps == steps.max(axis=0), steps, 0)
    return {name: int(row.argmax()) if row.any() else -1 for name, row in zip(names, theirs, strict=True)}
