"""What a finished cell holds, read as its plan says that it must be: the agent's arrays, its trials."""

from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from pathlib import Path

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.declared import RANDOM_STATE, Declared, fault_in_form, fault_in_values
from visitlab_cli.agents.exploration import Table
from visitlab_cli.config.experiment import lab_of
from visitlab_cli.errors import AnswerError, RunError, VisitlabError
from visitlab_cli.log.reader import read_metadata
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.evaluation import AS_DECLARED
from visitlab_cli.sources import is_kind_of_others
from visitlab_cli.storage.arrays import Arrays, damaged, read_model, read_trials
from visitlab_cli.storage.cell_folder import MODEL, STEPS, TRIALS
from visitlab_cli.storage.reading import UnreadableError, is_file
from visitlab_cli.terminal import to_stderr
from visitlab_cli.wording import printable, shown


def unsound(run: Path, cell: Cell) -> tuple[str, str] | None:
    """What is wrong with what a finished cell holds, as file and problem; None where it is as its plan says.

    Raises:
        UnreadableError: nobody can tell.
    """
    for name, read in ((MODEL, model_of), (TRIALS, partial(trials_of, as_planned=True)), (STEPS, _check_log)):
        try:
            read(run, cell)
        except UnreadableError:
            raise
        except VisitlabError as error:
            place = f"{printable(str(run / cell.path / name))}: "
            return name, str(error).removeprefix(place).removeprefix("damaged: ").partition("; visitlab runs verify")[0]
    return None


def _check_log(run: Path, cell: Cell) -> None:
    """Refuse a log that says of itself that it is another cell's; where none is recorded there is none."""
    file = run / cell.path / STEPS
    if not is_file(file):
        return
    about = read_metadata(file)
    for name, wanted in (("cell", cell.path), ("seed", str(cell.seed))):
        if about.get(name) != wanted:
            raise RunError(f"{printable(str(file))}: its metadata says {name} {shown(about.get(name))}, not {wanted}")


def setting_of(cell: Cell) -> Setting:
    """Where a cell's agent plays."""
    settings, config = cell.settings, cell.config
    lab, plays = lab_of(settings), settings.plays
    n_states, n_actions = plays.size(lab)
    setting = Setting(cell.task, n_states, n_actions, settings.n_steps, config.agents, config.seed, cell.path)
    return setting._replace(goals=plays.goals(lab))


def declared(cell: Cell) -> dict[str, Declared] | None:
    """What each array of a cell's `model.npz` must be; None where its agent's kind is not to be had."""
    if cell.config.agents[cell.agent].absent:
        return None
    kept = cell.settings.declared_kept()
    with to_stderr() if is_kind_of_others(type(cell.player)) else nullcontext():
        arrays = cell.player.arrays(setting_of(cell))
    return {**arrays, **kept, "random_state": RANDOM_STATE}


def check_model(cell: Cell, arrays: Arrays) -> None:
    """Check what is about to be saved as that which an agent of others has learned: what was saved must be read again.

    Ours are tested to be as they declare, and a check would be a tenth of a short cell.

    Raises:
        AnswerError: it lacks an array, or is not as the agent's kind declares.
    """
    if not is_kind_of_others(type(cell.player)):
        return
    for name, wanted in (declared(cell) or {}).items():
        if name not in arrays:
            raise AnswerError(f"it saved no array {name}")
        array = arrays[name]
        if fault := fault_in_form(wanted, array.dtype.str, array.shape) or fault_in_values(wanted, array):
            raise AnswerError(f"its array {name} {fault}")
    if fault := cell.player.fault(setting_of(cell), arrays):
        raise AnswerError(fault)


def model_of(run: Path, cell: Cell) -> Arrays:
    """What the agent of a finished cell learned.

    Raises:
        NotFoundError: it is missing.
        RunError: it is damaged, or is not what such an agent saves.
    """
    file = run / cell.path / MODEL
    arrays = read_model(file, declared(cell))
    fault = cell.player.fault(setting_of(cell), arrays)
    if fault:
        raise damaged(file, fault)
    return arrays


def values_of(run: Path, cell: Cell) -> Table:
    """What the agent of a finished cell believes each action is worth, shape (states, actions).

    Raises:
        NotFoundError, RunError: as `model_of`.
    """
    return cell.player.values(model_of(run, cell))


def models_of(run: Path, cell: Cell) -> dict[str, Arrays]:
    """The models of the world that the agent of a finished cell learned, by name; none of one that does not learn.

    Raises:
        NotFoundError, RunError: as `model_of`.
    """
    return cell.player.models(model_of(run, cell))


def modules_of(run: Path, cell: Cell) -> dict[str, Arrays]:
    """The models of the trained cells that a cell starts from, by their tasks.

    Raises:
        NotFoundError, RunError: as `model_of`.
    """
    found = {}
    for task, path in cell.modules.items():
        start = cell.settings.starts[task]
        trained = replace(cell, path=path, experiment=start.experiment, agent=start.agent, evaluation=AS_DECLARED)
        found[task] = model_of(run, trained)
    return found


def trials_of(run: Path, cell: Cell, *, as_planned: bool = False) -> Arrays:
    """The trials of a finished cell: `trial`, `reward`, in a visit `goals`, with phases `phase`, each (trials,).

    Args:
        run: the run's folder.
        cell: a cell of its plan.
        as_planned: whether there must be as many as planned; a config may have been edited since.

    Raises:
        NotFoundError: they are missing.
        RunError: they are damaged, or others than the plan says.
    """
    goals, phases = cell.settings.plays.counts_goals, cell.settings.phase_trials
    if not as_planned:
        return read_trials(run / cell.path / TRIALS, None, goals)
    return read_trials(run / cell.path / TRIALS, cell.trials, goals, phases)
