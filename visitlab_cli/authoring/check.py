"""What an agent must do to be run, stopped, resumed and compared, tried on small worlds; as check_env is of one.

The worlds are tables: of each task's size one in which every pair of state and action leads anywhere, and the chain
of two states, of which the second pays for the action that stays there.
"""

import json
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents import plain
from visitlab_cli.agents.base import AgentParameters, Player, Saved, Setting
from visitlab_cli.agents.declared import fault_in_saved
from visitlab_cli.authoring.kinds import agent_of
from visitlab_cli.errors import VisitlabError
from visitlab_cli.random_numbers import RandomState, random_state
from visitlab_cli.simulation.table import play_table
from visitlab_cli.storage.arrays import read_model, write_model
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.tasks import TASKS

STEPS, TRIAL_STEPS = 2_000, 20
CHAIN_STEPS, CHAIN_LAST, CHAIN_SHARE = 8_000, 2_000, 0.7
"""Steps on the chain, how many of the last count, and the share of the best reward that they must bring."""
SEED = 1


class Answer(NamedTuple):
    """One question: what was `asked`, of which `task`, whether it `passed`, and what was seen."""

    asked: str
    task: str
    passed: bool
    seen: str


class _FailedError(Exception):
    """An agent did not do what it must; the message says what it did."""


class _World(NamedTuple):
    """Where each pair of state and action leads, and what it brings: shape (states, actions) each."""

    next_states: npt.NDArray[np.int64]
    rewards: npt.NDArray[np.float64]


CHAIN = _World(np.array([[0, 1], [0, 1]]), np.array([[0.0, 0.0], [0.0, 1.0]]))
"""Of two states: action 1 leads to the second one, and pays there."""


def check_agent(kind: str, **parameters: Any) -> list[Answer]:
    """Every answer of an agent, as `visitlab plugin check` has it.

    Args:
        kind: as a config names it, built in, of an installed package, or of a file that VISITLAB_PLUGINS names.
        parameters: its parameters, where they are not as by default.

    Raises:
        NotFoundError, RunError, UsageError, ConfigError: as `authoring.kinds.agent_of`.
    """
    return list(check(agent_of(kind, [f"{name}={json.dumps(value)}" for name, value in parameters.items()])))


def check(parameters: AgentParameters) -> Iterator[Answer]:
    """Ask every question of an agent, one after another; the first of a task that it fails is its last there."""
    for task in parameters.playable:
        size, goals = TASKS[task].size(paper_lab()), TASKS[task].goals(paper_lab())
        setting = Setting(task, *size, STEPS, seed=SEED, cell=f"check/{task}", goals=goals)
        random = np.random.default_rng(SEED)
        world = _World(random.integers(0, size.n_states, size), np.where(random.random(size) < 0.1, 1.0, 0.0))
        questions: list[tuple[str, Callable[[AgentParameters, Setting, _World], str]]] = [
            (f"acts and learns for {STEPS:,} steps", _legal),
            ("does the same again", _deterministic),
            ("what it saves survives the disk", _saved),
            ("goes on where it stopped", _resumed),
            ("is greedy, and learns nothing, when frozen", _frozen),
        ]
        for asked, question in questions:
            answer = _asked(asked, task, question, parameters, setting, world)
            yield answer
            if not answer.passed:
                return
    if parameters.learns:
        setting = Setting(parameters.tasks[0], 2, 2, CHAIN_STEPS, seed=SEED, cell="check/chain")
        yield _asked("learns the chain of two states", "-", _chain, parameters, setting, CHAIN)


def _asked(
    asked: str,
    task: str,
    question: Callable[[AgentParameters, Setting, _World], str],
    parameters: AgentParameters,
    setting: Setting,
    world: _World,
) -> Answer:
    try:
        return Answer(asked, task, True, question(parameters, setting, world))
    except (_FailedError, VisitlabError) as error:
        return Answer(asked, task, False, str(error))
    except Exception as error:  # of a compiled agent, or of its create, save and restore
        return Answer(asked, task, False, plain.in_a_line(error))


class _Played(NamedTuple):
    """A record that has played, the actions that it took, shape (steps,), and where it and its draws are now."""

    record: Any
    actions: npt.NDArray[np.int64]
    state: int
    random: RandomState


def _play(record: Any, world: _World, steps: int, first: int = 1, state: int = 0, random: Any = None) -> _Played:
    draws = random_state(SEED, "check", "draws") if random is None else random.copy()
    actions = np.full(steps, -1)
    try:
        state = play_table(record, state, first, *world, TRIAL_STEPS, draws, actions)
    except RuntimeError as error:
        raise plain.failure_in(record, TRIAL_STEPS) or error from None
    if state < 0:
        n_actions = world.rewards.shape[1]
        wrong = int(np.argmax((actions < 0) | (actions >= n_actions)))  # what follows was never chosen
        raise _FailedError(f"at step {first + wrong} it chose {actions[wrong]}; actions go from 0 to {n_actions - 1}")
    return _Played(record, actions, int(state), draws)


def _legal(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    played = _play(parameters.create(setting), world, STEPS)
    return f"{len(set(played.actions.tolist()))} of {setting.n_actions} actions"


def _deterministic(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    first, second = (_play(parameters.create(setting), world, STEPS) for _ in range(2))
    _same_actions(first.actions, second.actions, 1)
    saved = parameters.save(first.record)
    if fault := fault_in_saved(saved):  # of what is no number nothing is the same
        raise _FailedError(fault)
    _same_arrays(saved, parameters.save(second.record), "the second time")
    return "the same actions and arrays"


def _saved(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    arrays = parameters.save(_play(parameters.create(setting), world, STEPS).record)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "model.npz"
        write_model(file, arrays)
        read = read_model(file, parameters.arrays(setting))
    _same_arrays(arrays, read, "read again")
    if fault := parameters.fault(setting, read):
        raise _FailedError(fault)
    if plain.VALUES in read and read[plain.VALUES].shape != (setting.n_states, setting.n_actions):
        raise _FailedError(f"{plain.VALUES} has shape {read[plain.VALUES].shape}, not (states, actions)")
    return ", ".join(f"{name} {array.dtype} {array.shape}" for name, array in read.items())


def _resumed(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    half = STEPS // 2
    whole = _play(parameters.create(setting), world, STEPS)
    begun = _play(parameters.create(setting), world, half)
    saved = {name: array.copy() for name, array in parameters.save(begun.record).items()}
    rest = _play(_restored(parameters, setting, saved), world, STEPS - half, half + 1, begun.state, begun.random)
    _same_actions(whole.actions[half:], rest.actions, half + 1)
    _same_arrays(parameters.save(whole.record), parameters.save(rest.record), "where it was saved half way")
    return f"saved at step {half:,}, restored, the same future"


def _restored(parameters: AgentParameters, setting: Setting, saved: Saved) -> Any:
    if parameters.compiled():
        return parameters.restore(setting, saved)
    return plain.restored(parameters, setting, saved, same_draws=True)


def _frozen(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    saved = parameters.save(_play(parameters.create(setting), world, STEPS).record)
    frozen: Player = parameters.frozen
    first, second = (_play(frozen.restore(setting, saved), world, STEPS) for _ in range(2))
    _same_actions(first.actions, second.actions, 1)
    before, after = frozen.save(frozen.restore(setting, saved)), frozen.save(first.record)
    for arrays in (before, after):
        arrays.pop(plain.OWN_RANDOM, None)  # it may draw, between equals
    _same_arrays(before, after, "after it played, frozen")
    return f"{len(set(first.actions.tolist()))} of {setting.n_actions} actions, nothing learned"


def _chain(parameters: AgentParameters, setting: Setting, world: _World) -> str:
    played = _play(parameters.create(setting), world, CHAIN_STEPS)
    share = float((played.actions[-CHAIN_LAST:] == 1).mean())
    if share < CHAIN_SHARE:
        raise _FailedError(
            f"in the last {CHAIN_LAST:,} of {CHAIN_STEPS:,} steps it took the better action in {share:.0%}"
        )
    return f"the better action in {share:.0%} of the last {CHAIN_LAST:,} steps"


def _same_actions(first: npt.NDArray[np.int64], second: npt.NDArray[np.int64], begin: int) -> None:
    if (first != second).any():
        at = int(np.argmax(first != second))
        raise _FailedError(f"at step {begin + at} it chose {first[at]} the first time and {second[at]} the second")


def _same_arrays(first: Saved, second: Saved, when: str) -> None:
    if first.keys() != second.keys():
        raise _FailedError(f"its arrays are {', '.join(first)}, and {when} {', '.join(second)}")
    for name, array in first.items():
        if not np.array_equal(array, second[name]):
            raise _FailedError(f"its array {name} is another {when}")
