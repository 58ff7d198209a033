"""Agents in plain Python: objects whose methods the compiled loop calls, a step at a time.

To the loop such an agent is a record like any other, of the addresses of two functions; so it plays every task,
steers a visit, is watched and learned from. What it draws comes from a numpy Generator of its own.
"""

import inspect
import operator
import re
import traceback
import weakref
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from numba.core.errors import NumbaError

from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import RESERVED, fault_in_saved
from visitlab_cli.callbacks import Signature
from visitlab_cli.errors import RunError
from visitlab_cli.random_numbers import RandomState, random_state
from visitlab_cli.wording import cut

STREAM = "agent"
OWN_RANDOM = "agent_random_state"
"""The array of the state that its generator is left in: four words of SFC64, then the half of one that is left."""
VALUES = "q"
_NOT_ITS_OWN = (*RESERVED, OWN_RANDOM)
_FAILED = -1
_ACT, _LEARN = Signature(int, int), Signature(int, int, float, int, int, int)
_act, _learn = _ACT.caller(), _LEARN.caller()
_PLACE = re.compile(r'^[ \t]*File "([^"]+)", line (\d+):\n(?:\s*def (\w+))?', re.MULTILINE)
"""How the compiler says where it stopped, innermost first; before it stands, after `_STOPPED`, the reason."""
_STOPPED = "Failed in nopython mode pipeline"
LONGEST_REASON = 160


class PlainAgent(Protocol):
    """What an agent in plain Python is asked; `values` and `greedy` may be missing.

    States and actions are whole numbers from 0; `step` counts the agent's steps from 1; `random` is the same numpy
    Generator each time, in which the agent may draw as much as it likes.
    """

    def act(self, state: int, random: np.random.Generator, step: int) -> int | tuple[int, bool]:
        """The action, or the action and whether it was taken to explore."""

    def learn(
        self,
        state: int,
        action: int,
        reward: float,
        next_state: int,
        end: bool,
        random: np.random.Generator,
        step: int,
    ) -> None:
        """Learn from one transition; `end` says that the trial ends with it, though the task goes on."""

    def arrays(self) -> Mapping[str, npt.NDArray[Any]]:
        """All that it has learned, by name: what `model.npz` keeps."""

    def restore(self, arrays: Mapping[str, npt.NDArray[Any]]) -> None:
        """Go on from what `arrays` gave."""


class AgentFailedError(RunError):
    """An agent in plain Python raised, or answered what it must not; `report` is its traceback."""

    def __init__(self, message: str, report: str = "") -> None:
        """With the traceback, empty where there is none."""
        super().__init__(message)
        self.report = report

    def __reduce__(self) -> Any:
        """Another process gets all of it."""
        return type(self), (str(self), self.report)


class FrozenPlain:
    """The parameters of an agent that is greedy and learns nothing: it saves what it was."""

    def __init__(self, parameters: AgentParameters) -> None:
        """Of these."""
        self.save, self.arrays, self.values = parameters.save, parameters.arrays, parameters.values
        self._parameters = parameters

    def restore(self, setting: Setting, saved: Saved) -> "Plain":
        """By its own `greedy`."""
        return restored(self._parameters, setting, saved, frozen=True)

    def models(self, saved: Saved) -> dict[str, Saved]:
        """None, as of whoever learns nothing."""
        return {}

    def fault(self, setting: Setting, saved: Saved) -> str | None:
        """Nothing is wrong with arrays that are as they were declared."""
        return None


class Plain(NamedTuple):
    """The addresses of what `act` and `learn` are called by, and the number that the agent is known under here."""

    act: int
    learn: int
    number: npt.NDArray[np.int64]  # shape (1,): the agent is kept for as long as this array


class Playing:
    """An agent that plays: its generator, its callbacks, and what went wrong in one of them."""

    def __init__(self, agent: PlainAgent, kind: str, setting: Setting, stream: RandomState, *, frozen: bool) -> None:
        """Ready to be called."""
        self.agent, self.kind, self.setting = agent, kind, setting
        self.bits = np.random.SFC64()
        self.random = np.random.Generator(self.bits)
        self.set_random(np.append(stream, np.zeros(2, np.uint64)))
        self.error: BaseException | None = None
        self.step = 0
        self.callbacks = _ACT.address(self._acting(frozen)), _LEARN.address(self._learning(frozen))

    def record(self) -> Plain:
        """What the loop is given."""
        number = np.array([id(self)])
        _playing[id(self)] = self
        weakref.finalize(number, _playing.pop, id(self))
        acting, learning = self.callbacks
        return Plain(acting.address, learning.address, number)

    def random_state(self) -> RandomState:
        """The whole state of the generator, shape (6,)."""
        state = self.bits.state
        return np.append(state["state"]["state"], np.array([state["has_uint32"], state["uinteger"]], np.uint64))

    def set_random(self, state: RandomState) -> None:
        """Let the generator go on from a state, shape (6,)."""
        whole: Any = {"bit_generator": "SFC64", "state": {"state": state[:4].astype(np.uint64)}}
        self.bits.state = whole | {"has_uint32": int(state[4]), "uinteger": int(state[5])}

    def failure(self, trial_steps: int) -> AgentFailedError | None:
        """What went wrong, with the trial and the step in it, counted as in the log; None where nothing did."""
        if self.error is None:
            return None
        trial, step = divmod(self.step - 1, trial_steps)
        message = f"its agent (kind {self.kind}) failed in trial {trial}, step {step + 1}: {in_a_line(self.error)}"
        return AgentFailedError(message, "".join(traceback.format_exception(self.error)))

    def _acting(self, frozen: bool) -> Callable[[int, int], int]:
        act, random, n_actions, index = self.agent.act, self.random, self.setting.n_actions, operator.index
        greedy: Any = getattr(self.agent, "greedy", None)
        method = "greedy" if frozen else "act"

        def answer(state: int, step: int) -> int:
            try:
                chosen: Any = greedy(state) if frozen else act(state, random, step)
                explored = False
                if type(chosen) is tuple:
                    chosen, explored = chosen
                try:
                    action = index(chosen)
                except TypeError:
                    raise TypeError(f"{method} answered {cut(repr(chosen))}; an action is a whole number") from None
                if 0 <= action < n_actions:
                    return 2 * action + bool(explored)
                raise ValueError(f"{method} answered {action}, but actions go from 0 to {n_actions - 1}")
            except BaseException as error:  # nothing may be raised through the kernel
                self.step, self.error = step, error
                return _FAILED

        return answer

    def _learning(self, frozen: bool) -> Callable[[int, int, float, int, int, int], int]:
        learn, random = self.agent.learn, self.random

        def answer(state: int, action: int, reward: float, next_state: int, end: int, step: int) -> int:
            try:
                if not frozen:
                    learn(state, action, reward, next_state, end == 1, random, step)
                return 0
            except BaseException as error:
                self.step, self.error = step, error
                return _FAILED

        return answer


_playing: dict[int, Playing] = {}


def created(parameters: AgentParameters, setting: Setting) -> Plain:
    """The record of a new agent of a kind in plain Python.

    Raises:
        AgentFailedError: its maker raised, or what it made lacks a method.
    """
    return _begin(parameters, setting).record()


def restored(
    parameters: AgentParameters, setting: Setting, saved: Saved, *, frozen: bool = False, same_draws: bool = False
) -> Plain:
    """The record of an agent that goes on from what `saved` gave.

    Args:
        parameters: its kind's.
        setting: where it plays now.
        saved: its arrays.
        frozen: whether it is greedy and learns nothing.
        same_draws: whether its generator goes on, too; else it draws from the stream of the cell that it plays in.

    Raises:
        AgentFailedError: it raised, or lacks a method.
    """
    playing = _begin(parameters, setting, frozen=frozen)
    own = {name: saved[name].copy() for name in saved if name not in _NOT_ITS_OWN}
    _asked(parameters, "restore", lambda: playing.agent.restore(own))
    if same_draws:
        playing.set_random(saved[OWN_RANDOM])
    return playing.record()


def saved(parameters: AgentParameters, record: Plain) -> Saved:
    """The agent's arrays, what it believes actions are worth where it says so, and its generator's state.

    Raises:
        AgentFailedError: it raised, or gave what is no array of numbers, or can't be called so.
    """
    playing = _playing[int(record.number[0])]
    answered = _asked(parameters, "arrays", playing.agent.arrays)
    if not isinstance(answered, Mapping):
        raise _failed(parameters, f"arrays answered {cut(repr(answered))}, not arrays by name")
    arrays = {name: _array(parameters, f"its array {cut(str(name))}", array) for name, array in answered.items()}
    if values := getattr(playing.agent, "values", None):
        table = _array(parameters, "values", _asked(parameters, "values", values), np.float64)
        if VALUES in arrays and not np.array_equal(arrays[VALUES], table, equal_nan=True):
            raise _failed(parameters, f"its array {VALUES} is not what values answers, which is kept by this name")
        arrays[VALUES] = table
    if fault := fault_in_saved(arrays, _NOT_ITS_OWN):
        raise _failed(parameters, fault)
    return {**arrays, OWN_RANDOM: playing.random_state()}


def _array(parameters: AgentParameters, what: str, given: Any, dtype: Any = None) -> npt.NDArray[Any]:
    found: npt.NDArray[Any] = _asked(parameters, what, lambda: np.asarray(given, dtype))
    return found


def failure_in(record: Any, trial_steps: int) -> AgentFailedError | None:
    """What went wrong in an agent of plain Python that is, or is within, a record."""
    if isinstance(record, Plain):
        return _playing[int(record.number[0])].failure(trial_steps)
    parts = record if isinstance(record, tuple) else ()
    return next(filter(None, (failure_in(part, trial_steps) for part in parts)), None)


def in_a_line(error: BaseException) -> str:
    """An exception and what it says, first line; of code that can't be compiled the reason, and where."""
    if isinstance(error, NumbaError):
        return f"can't be compiled: {_uncompiled(str(error))}"
    return f"{type(error).__name__}: {error}".splitlines()[0]


def _uncompiled(text: str) -> str:
    """Why the compiler stopped, and where, of all that it says."""
    place = _PLACE.search(text)
    _, stopped, told = text[: place.start() if place else None].rpartition(_STOPPED)
    lines = [line.strip() for line in told.splitlines() if line.strip()]
    called = next((line.removeprefix(">>> ") for line in lines if line.startswith(">>> ")), "")
    reason = f"no implementation of {called}" if called else next(iter(lines[bool(stopped) :]), "no reason is told")
    where = f" ({', '.join(filter(None, (Path(place[1]).name, f'line {place[2]}', place[3])))})" if place else ""
    return f"{reason[:LONGEST_REASON]}{where}"


def _begin(parameters: AgentParameters, setting: Setting, *, frozen: bool = False) -> Playing:
    agent = _asked(parameters, "agent", lambda: parameters.agent(setting))
    wanted = {"act": 3, "learn": 7, "arrays": 0, "restore": 1} | ({"greedy": 1} if frozen else {})
    for method, count in wanted.items():
        _check_method(parameters, agent, method, count)
    stream = random_state(setting.seed, setting.cell, STREAM)
    return Playing(agent, parameters.kind, setting, stream, frozen=frozen)


def _check_method(parameters: AgentParameters, agent: Any, method: str, count: int) -> None:
    there = getattr(agent, method, None)
    if not callable(there):
        raise _failed(parameters, f"a {type(agent).__name__} has no method {method}")
    try:
        inspect.signature(there).bind(*range(count))
    except TypeError as error:
        raise _failed(parameters, f"{method} must take {count} arguments: {error}") from error
    except ValueError:
        pass  # of no signature that Python knows


def _asked(parameters: AgentParameters, what: str, ask: Callable[[], Any]) -> Any:
    try:
        return ask()
    except Exception as error:
        raise _failed(parameters, f"{what}: {in_a_line(error)}", traceback.format_exc()) from error


def _failed(parameters: AgentParameters, message: str, report: str = "") -> AgentFailedError:
    return AgentFailedError(f"its agent (kind {parameters.kind}) failed: {message}", report)


@CHOOSE.of(Plain)
def choose(agent: Plain, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """As `act` answers."""
    answer = _act(agent.act, state, step)
    if answer < 0:
        raise RuntimeError("an agent in plain Python failed")
    return answer // 2, answer % 2 == 1


@LEARN.of(Plain)
def learn(
    agent: Plain,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """As `learn` does."""
    if _learn(agent.learn, state, action, float(reward), next_state, int(end), step) < 0:
        raise RuntimeError("an agent in plain Python failed")
