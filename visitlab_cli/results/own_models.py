"""How well an agent of several models told humans apart: its switches beside who was really there."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.model_switching import MEMORY
from visitlab_cli.plan.cells import Cell

Ints = npt.NDArray[np.int64]


class Met(NamedTuple):
    """A phase: its human, and whether at each of its steps the human's own model was active.

    A human's own model is the one that was active in most of the steps with that human, over all phases.
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
    for human, models in zip(humans, active, strict=True):
        of_human = np.concatenate([each for each, there in zip(active, humans, strict=True) if there == human])
        yield Met(human, models == np.bincount(of_human).argmax())
