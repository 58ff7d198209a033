"""One cell from beginning to end: build, play block by block, record, save, commit."""

import contextlib
import socket
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.declared import fault_in_saved
from visitlab_cli.agents.plain import failure_in
from visitlab_cli.config.canonical import hashed_yaml
from visitlab_cli.errors import AnswerError, Interrupted
from visitlab_cli.execution.build import Simulation, build
from visitlab_cli.execution.checkpoints import Checkpoints, Standing
from visitlab_cli.execution.failures import kept_if_it_fails
from visitlab_cli.execution.versions import decided_by, versions
from visitlab_cli.log.writer import StepRecorder
from visitlab_cli.plan.cells import Cell
from visitlab_cli.plan.saved import check_model, modules_of
from visitlab_cli.random_numbers import RandomState, random_state
from visitlab_cli.simulation.loop import BLOCK_ROWS, play
from visitlab_cli.sources import is_kind_of_others
from visitlab_cli.storage.arrays import write_model, write_trials
from visitlab_cli.storage.cell_folder import MODEL, STEPS, TRIALS, NewCell
from visitlab_cli.storage.facts import CPU_SECONDS
from visitlab_cli.world.columns import StepColumns, empty_columns

Report = Callable[[int], None]
"""Told after each block how many steps of the cell are done; raises `Interrupted` to stop it."""

Record = Callable[[StepColumns, int], None]
"""Given a block and its number of rows."""

STREAM = "simulation"


class Spent(NamedTuple):
    """Time spent playing: `seconds` of the clock, and those of one core, which other programs do not lengthen."""

    seconds: float
    cpu_seconds: float


def nothing(told: Any) -> None:
    """Do nothing with what is told."""


def run_cell(run: Path, cell: Cell, report: Report, goes_on: Report = nothing) -> None:
    """Simulate `cell` and commit its folder in the run folder `run`; `goes_on` is told from which step, if not 0.

    Raises:
        RunError: a model is damaged, something can't be written, or its agent or human raised.
        Interrupted: `report` said so; what is left behind of a long cell is gone on from.
    """
    with kept_if_it_fails(run, cell):
        _run_cell(run, cell, report, goes_on)


def _run_cell(run: Path, cell: Cell, report: Report, goes_on: Report) -> None:
    begun = time.monotonic()
    models = modules_of(run, cell)
    simulation = build(cell, models)
    random = random_state(cell.config.seed, cell.path, STREAM)
    if is_kind_of_others(type(cell.player)):
        saved_model(simulation, random)  # what can't be kept is told before it is learned
    with NewCell(run, cell.path) as new:
        with _recorder(cell, new.folder / STEPS) as recorder:

            def alive(steps: int) -> None:
                new.beat(steps)
                report(steps)

            checkpoints = Checkpoints(cell, new, simulation, random, recorder, begun)
            standing = checkpoints.go_on(run, Standing(np.zeros(simulation.trials)))
            if standing.cursor.steps:
                goes_on(standing.cursor.steps)
            record = nothing_recorded if recorder is None else recorder.write
            try:
                trial_rewards, spent = simulate(simulation, random, record, alive, standing, checkpoints.after_block)
            except Interrupted:
                checkpoints.interrupted()
                raise
        settings = cell.settings
        goals, phases = settings.plays.counts_goals, settings.phase_trials
        write_trials(new.folder / TRIALS, trial_rewards, with_goals=goals, phase_trials=phases)
        model = saved_model(simulation, random)
        check_model(cell, model)
        write_model(new.folder / MODEL, model)
        timing = _timing(checkpoints.began, checkpoints.seconds, cell.steps, spent)
        described = {} if recorder is None else {STEPS: recorder.described()}
        new.commit(facts_of(cell, trial_rewards), timing, described)


def nothing_recorded(columns: StepColumns, rows: int) -> None:
    """Keep no steps."""


def simulate(
    simulation: Simulation,
    random: RandomState,
    record: Record,
    report: Report,
    standing: Standing | None = None,
    stands: Callable[[Standing], None] = nothing,
) -> tuple[np.ndarray[Any, np.dtype[np.float64]], Spent]:
    """Play to the end in blocks: the rewards of all trials, shape (trials,), and the time spent playing.

    Args:
        simulation: what is played; its agents go on learning in place.
        random: the cell's stream, changed in place.
        record: given each block.
        report: told after it how far the cell is.
        standing: where to go on, from the beginning if not given.
        stands: told after each block where the cell stands.

    Raises:
        AgentFailedError: an agent in plain Python raised, or answered what it must not.
    """
    columns = empty_columns(BLOCK_ROWS)
    trial_rewards, cursor, begun_with, seconds, cpu_seconds = standing or Standing(np.zeros(simulation.trials))
    for number, (task, agent, until, open_doors, begin) in enumerate(simulation.stretches):
        columns.phase[:] = number
        if number > begun_with:
            if begin is not None:
                begin()
            cursor = cursor._replace(scene=cursor.scene._replace(open_doors=open_doors))
        while cursor.steps < until:
            begun, of_core = time.perf_counter(), time.thread_time()
            try:
                cursor, rows = play(task, agent, cursor, until, random, columns, trial_rewards)
            except RuntimeError:
                if failure := failure_in(agent, task.trial_steps):
                    raise failure from None
                raise
            seconds += time.perf_counter() - begun
            cpu_seconds += time.thread_time() - of_core
            record(columns, rows)
            stands(Standing(trial_rewards, cursor, number, seconds, cpu_seconds))
            report(cursor.steps)
    return trial_rewards, Spent(seconds, cpu_seconds)


@contextlib.contextmanager
def _recorder(cell: Cell, file: Path) -> Iterator[StepRecorder | None]:
    one_trial_in = cell.config.record.one_trial_in
    if not one_trial_in:
        yield None
        return
    attributes = {
        "cell": cell.path,
        "seed": str(cell.seed),
        "config_hash": cell.run_hash,
        "version": versions()["visitlab"],
    }
    document = hashed_yaml(cell.config).encode()
    with StepRecorder(
        file, cell.task, attributes=attributes, config_yaml=document, one_trial_in=one_trial_in, parts=cell.parts
    ) as recorder:
        yield recorder


def saved_model(simulation: Simulation, random: RandomState) -> Saved:
    """The arrays of `model.npz`: the agent's, what its task keeps, and the state that the random stream is left in.

    Raises:
        AnswerError: the agent's can't be kept.
    """
    kept = simulation.experiment.kept_by(simulation.stretches[-1].task)
    saved = simulation.parameters.save(simulation.agent)
    if fault := fault_in_saved(saved):
        raise AnswerError(fault)
    return {**saved, **kept, "random_state": random}


def facts_of(cell: Cell, trial_rewards: np.ndarray[Any, np.dtype[np.float64]]) -> dict[str, Any]:
    """What `cell.json` says of a cell with these rewards, shape (trials,)."""
    return {
        **decided_by(cell),
        "seed": cell.seed,
        "steps": cell.steps,
        "trials": len(trial_rewards),
        "mean_reward_last_hundredth": last_mean(trial_rewards, 100),
        "mean_reward_last_tenth": last_mean(trial_rewards, 10),
    }


def last_mean(trial_rewards: np.ndarray[Any, np.dtype[np.float64]], part: int) -> float:
    """Mean of the last `1 / part` of the trials, at least of one."""
    return float(trial_rewards[-max(1, len(trial_rewards) // part) :].mean())


def _timing(began: datetime, seconds: float, steps: int, spent: Spent) -> dict[str, Any]:
    return {
        "start": began.isoformat(),
        "end": datetime.now(UTC).isoformat(),
        "seconds": round(seconds, 3),
        CPU_SECONDS: round(spent.cpu_seconds, 6),
        "steps_per_second": round(steps / spent.seconds),
        "host": socket.gethostname(),
    }
