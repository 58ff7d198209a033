"""Compiling before the workers start, once, and saying so; a damaged cache is thrown away and made anew.

Of several runners that share a cache, as the jobs on a node of a cluster do, one compiles and the others wait for it.
"""

import contextlib
import math
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.agents.base import Saved, Setting
from visitlab_cli.agents.plain import AgentFailedError
from visitlab_cli.compiled import JIT_DISABLED, place_of, records_in
from visitlab_cli.config.experiment import lab_of
from visitlab_cli.errors import VisitlabError
from visitlab_cli.execution.build import Simulation, build
from visitlab_cli.execution.cell_runner import simulate
from visitlab_cli.kernel_cache import VARIABLE, KernelCache, Place
from visitlab_cli.kinds import kind
from visitlab_cli.plan.cells import Cell
from visitlab_cli.random_numbers import random_state
from visitlab_cli.stopping import check_asked, nothing_to_lose
from visitlab_cli.storage.locks import HeldError, Lock, lock
from visitlab_cli.world.columns import StepColumns

COMPILED = "compiled-"
SECONDS = 2.5
"""What compiling the loop of a pair takes on an ordinary core; with a controller that plans it is five times that."""
COMPILING = ".compiling"
"""The file in the cache that is locked by who compiles."""
LONGEST_WAIT, LOOK = 600.0, 0.2
"""Seconds that another is waited for, who may hang; then both compile, which does no harm. And between two looks."""
_compiled_here: set[str] = set()
"""The names of the pairs that this process has compiled or loaded."""


def warm_up(cells: Sequence[Cell], say: Callable[[str], None]) -> None:
    """Compile or load the loop for every pair of task and agent among `cells`, telling the user by `say`."""
    if JIT_DISABLED:
        return
    check_asked()
    with nothing_to_lose():
        _warm_up(cells, say)


def one_for_each(cells: Sequence[Cell]) -> list[Cell]:
    """A cell for each pair of task and agent."""
    return list({_pair(cell): cell for cell in cells}.values())


def compile_here(cell: Cell) -> None:
    """Compile or load in this process, once, what `cell` needs, so that what it does afterwards is simulation."""
    if not JIT_DISABLED and _pair(cell) not in _compiled_here:
        with _told_by_the_cell():
            _play(_one_step(cell))
            _compiled_here.add(_pair(cell))


class _Loop(NamedTuple):
    """The loop of a pair, and the file that says that it has been compiled, if its code is kept anywhere."""

    name: str
    simulation: Simulation
    place: Place
    marker: Path | None

    @property
    def is_new(self) -> bool:
        """Whether it must be compiled."""
        return self.marker is None or not self.marker.exists()


def _warm_up(cells: Sequence[Cell], say: Callable[[str], None]) -> None:
    KernelCache.damage_found = cache(lambda: say("the cache of compiled code is damaged: compiling again"))
    loops: list[_Loop] = []
    for cell in one_for_each(cells):
        with _told_by_the_cell():
            name, simulation = _pair(cell), _one_step(cell)
            place = place_of(records_in(tuple(stretch[:2] for stretch in simulation.stretches)))
            loops.append(_Loop(name, simulation, place, place.folder and place.folder / (COMPILED + name)))
    with _alone(loops, say):
        new = [loop for loop in loops if loop.is_new]
        if new and new[0].marker is None:
            say(f"compiling (each time: {new[0].place.why}; set {VARIABLE} to a folder of your own)")
        elif new:
            say(f"compiling (first run only, some {10 * math.ceil(SECONDS * len(new) / 10)} seconds)")
        _play_all(loops)


def _play_all(loops: Sequence[_Loop]) -> None:
    for loop in loops:
        with _told_by_the_cell():
            _play(loop.simulation)
            _compiled_here.add(loop.name)
            if loop.marker is not None:
                with contextlib.suppress(OSError):
                    loop.marker.touch()


@contextlib.contextmanager
def _alone(loops: Sequence[_Loop], say: Callable[[str], None]) -> Iterator[None]:
    """Hold the cache, where some of the loops must be compiled and are then kept; what is there needs none."""
    marker = next((loop.marker for loop in loops if loop.is_new), None)
    held = None if marker is None else _held(marker.with_name(COMPILING), say)
    try:
        yield
    finally:
        if held is not None:
            held.release(remove=True)


def _held(file: Path, say: Callable[[str], None]) -> Lock | None:
    """The lock of a cache; None where there are no locks, or its holder takes too long."""
    until, waits = time.monotonic() + LONGEST_WAIT, False
    while time.monotonic() < until:
        try:
            return lock(file)
        except HeldError:
            if not waits:
                say("another process is compiling: waiting for it")
            waits = True
            time.sleep(LOOK)
        except OSError:
            return None
    return None


@contextlib.contextmanager
def _told_by_the_cell() -> Iterator[None]:
    """Pass over what somebody else's kind raises: the cell will raise it, too, fail alone and keep its traceback."""
    try:
        yield
    except AgentFailedError:
        pass
    except VisitlabError:
        raise
    except Exception:
        pass


def _pair(cell: Cell) -> str:
    """A name for what decides the types that the loop is compiled for."""
    agent = cell.learner
    started = bool(cell.modules) and not cell.settings.assembled  # an observer that goes on is of another type
    kinds = [cell.task, cell.settings.played_as, "frozen" if cell.frozen else "", "started" if started else ""]
    agents = [agent, *(cell.config.agents[getattr(agent, other)] for other in agent.references)]
    kinds += [word for each in agents for word in (each.kind, each.played_as)]
    kinds += dict.fromkeys(kind(cell.config.humans[human]) for human in cell.humans)
    return "-".join(filter(None, kinds))


def _play(simulation: Simulation) -> None:
    simulate(simulation, random_state(0, "warm-up"), _forget, lambda steps: None)


def _forget(columns: StepColumns, rows: int) -> None:
    """Record nothing."""


def _one_step(cell: Cell) -> Simulation:
    experiments = {**cell.config.experiments, cell.experiment: cell.settings.for_one_trial()}
    short = replace(cell, config=cell.config.model_copy(update={"experiments": experiments}))
    found = build(short, _empty_models(cell))
    stretches = [stretch._replace(until=step) for step, stretch in enumerate(found.stretches, 1)]
    return found._replace(stretches=stretches)


def _empty_models(cell: Cell) -> dict[str, Saved]:
    """Models of the right types and sizes that have learned nothing."""
    agents, lab = cell.config.agents, lab_of(cell.settings)
    models = {}
    for role, start in cell.settings.starts.items():
        task = cell.config.experiments[start.experiment].plays
        setting = Setting(task.name, *task.size(lab), 1, agents, goals=task.goals(lab))
        models[role] = agents[start.agent].save(agents[start.agent].create(setting))
    return models
