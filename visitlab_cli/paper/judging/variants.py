"""What decides a curve, and the runs that decide something else: where a cause is looked for.

A variant of a curve is another run that has the curve under the same names, but in which some setting that decides
it is another. No list of variants is kept: whatever lies in the same runs folder is asked.
"""

import os
from collections.abc import Set
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.experiment import Experiment
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module
from visitlab_cli.errors import RunError
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.settings import Settings, as_yaml, key_of
from visitlab_cli.storage.run_folder import all_runs, read_config
from visitlab_cli.world.columns import HUMAN

Flat = dict[str, Any]
NOT_DECIDING = {"agents", "humans", "modules", "trials", "steps"}
"""Settings that only say how many curves there are, or where they end; a module's training length does decide."""


class Variant(NamedTuple):
    """A run and its plan."""

    run: Path
    cells: list[Cell]


def open_variant(run: Path) -> Variant:
    """A run as a variant.

    Raises:
        NotFoundError: this is no run folder.
        RunError: its config is damaged.
    """
    return Variant(run, plan(read_config(run)))


def variants_beside(run: Path) -> list[Variant]:
    """The other runs of the folder that `run` lies in; one whose config can't be read shows nothing and is left out."""
    here = Path(os.path.abspath(run))  # the folder that it was found in, even if it is a link to another place
    found = []
    for other in all_runs(here.parent):
        with suppress(RunError):
            found += [open_variant(other)] if other.resolve() != here.resolve() else []
    return found


def changes(cell: Cell, other: Cell) -> list[str] | None:
    """What decides the curve of `other` otherwise than that of `cell`, a line each; None for another curve.

    The two cells have the same group; where a visit's modules have other names it is another curve.
    """
    ours, theirs = deciding(cell), deciding(other)
    if any(ours.get(path) != theirs.get(path) for path in ours.keys() | theirs.keys() if path.endswith(".name")):
        return None
    return [
        f"{path}: {_shown(theirs, path)} (not {_shown(ours, path)})"
        for path in sorted(ours.keys() | theirs.keys())
        if ours.get(path) != theirs.get(path)
    ]


def deciding(cell: Cell) -> Flat:
    """Every setting that decides a curve, by a dotted path that says what it is."""
    config, settings = cell.config, cell.settings
    if not settings.assembled:
        names = Module(cell.experiment, cell.agent, cell.human)
        return _training(config, names, NOT_DECIDING) | _distances(cell)
    found = _settings("visit", settings, NOT_DECIDING)
    found |= _humans(config, settings, cell.human)
    found |= _distances(cell)
    for task, module in settings.starts.items():
        training = _training(config, module, NOT_DECIDING - {"steps"})
        found |= {f"{task}.name": module.text} | {f"{task}.{path}": value for path, value in training.items()}
    return found


def _training(config: Config, names: Module, without: Set[str]) -> Flat:
    settings = config.experiments[names.experiment]
    found = _settings("training", settings, without)
    agent = config.agents[names.agent]
    found |= _settings("agent", agent, {key_of(type(agent), role) for role in agent.references})
    for role in agent.references:
        found |= _settings(f"agent.{role}", config.agents[getattr(agent, role)])
    found |= _humans(config, settings, names.human or "")
    for module in settings.starts.values():
        start = _training(config, module, NOT_DECIDING - {"steps"})
        found |= {f"start.{path}": value for path, value in start.items()}
    return found


def _humans(config: Config, settings: Experiment, name: str) -> Flat:
    """The human's, or those of each human of its phases under its name."""
    if name not in settings.humans_met(name):
        of_each = (_settings(f"human.{human}", config.humans[human]) for human in settings.humans_met(name))
        return {path: value for found in of_each for path, value in found.items()}
    return _settings("human", config.humans[name]) if name else {}


def _settings(path: str, settings: Settings, without: Set[str] = frozenset()) -> Flat:
    return _flat(path, {key: value for key, value in as_yaml(settings).items() if key not in without})


def _distances(cell: Cell) -> Flat:
    """Nothing where there is nobody to be at a distance from."""
    return _flat("distances", list(cell.config.interaction.distances)) if cell.settings.plays.has(HUMAN) else {}


def _flat(path: str, value: Any) -> Flat:
    if not isinstance(value, dict):
        return {path: value}
    return {where: leaf for key, inner in value.items() for where, leaf in _flat(f"{path}.{key}", inner).items()}


def _shown(flat: Flat, path: str) -> str:
    return str(flat.get(path, "missing"))
