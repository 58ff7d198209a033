"""What `visitlab eval` with options of its own played on a run's models."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from visitlab_cli.config.model import Config
from visitlab_cli.config.names import module
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.plan.evaluation import Evaluation, recorded_evaluations
from visitlab_cli.storage.cell_folder import read_cell


def evaluated(run: Path, config: Config) -> dict[Evaluation, list[Cell]]:
    """The cells of each recorded evaluation of a run, in groups of which something is finished.

    An evaluation says nothing of which visits it played: what has begun, it played.
    """
    found = {options: list(_begun(run, cells_of(config, options))) for options in recorded_evaluations(run)}
    return {options: cells for options, cells in found.items() if cells}


def cells_of(config: Config, options: Evaluation) -> list[Cell]:
    """All cells that an evaluation may have; none where the config has not what its options name."""
    return plan(config, options) if _declared(config, options) else []


def _begun(run: Path, cells: Sequence[Cell]) -> Iterator[Cell]:
    begun = {cell.group for cell in cells if read_cell(run / cell.path) is not None}
    yield from (cell for cell in cells if cell.group in begun)


def _declared(config: Config, options: Evaluation) -> bool:
    """Whether the config (which may have been edited) has what the options name."""
    names = {*options.humans}
    if options.social:
        social = module(options.social)
        training = config.experiments.get(social.experiment)
        if training is None or social.agent not in training.trained:
            return False
        if social.human not in training.met:
            return False
    return names <= set(config.humans)
