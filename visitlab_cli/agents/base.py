"""What an agent is to the rest of the package: validated parameters, a record of arrays, and two operations.

An agent's file holds its parameters (a pydantic model, from the YAML), its record (a NamedTuple of arrays and
numbers, the only thing that kernels see) and its kernels, registered with `CHOOSE` and `LEARN` for that record.
"""

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, NamedTuple, Protocol, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field

from visitlab_cli.agents.declared import LARGEST, Declared
from visitlab_cli.compiled import Operation
from visitlab_cli.kinds import Kind
from visitlab_cli.world.tasks import TASK_NAMES

Saved = dict[str, npt.NDArray[Any]]
"""An agent's arrays by name, as `model.npz` keeps them."""

GAMMA = Field(default=0.9, ge=0, lt=1, description="discount factor")
EPSILON = Field(default=0.05, ge=0, le=1, description="probability of a uniformly random action")
PLAN_EVERY = Field(default=1000, ge=1, le=10**9, description="steps between two sweeps of value iteration")


class AgentParameters(Kind):
    """An agent as the YAML declares it; a subclass adds `kind` (a Literal) and its numbers."""

    plans: ClassVar[bool] = False
    """Whether it sweeps a learned model, so that planning options mean something."""

    learns: ClassVar[bool] = True
    """Whether what it saves grows with what it meets."""

    tasks: ClassVar[tuple[str, ...]] = TASK_NAMES
    """The tasks that it can play."""

    takes_masks: ClassVar[bool] = False
    """Whether what plays as its social module can be told that an action comes to another (`CHOOSE_AS`)."""

    microseconds_a_step: ClassVar[Mapping[str, float]] = {}
    """What a step costs, by task, for the estimate before a run: of a whole cell on one core, in a visit as its
    social module; where it is not told, the dearest of the kinds that do stands in."""

    pools: ClassVar[bool] = False
    """Whether a visit can begin with what several of its kind have learned, as one."""

    parts: ClassVar[tuple[str, ...]] = ()
    """What the log of a visit has of it, of `SOME_CELLS`; its record is then asked to `TELL`."""
    kind: str

    references: ClassVar[dict[str, tuple[str, ...]]] = {}
    """Fields that name another declared agent, with the kinds that this one may have (none given: any
    that refers to no other)."""

    @property
    def played_as(self) -> str:
        """What of its settings decides the type of its record; empty by default."""
        return ""

    @property
    def playable(self) -> tuple[str, ...]:
        """The tasks that it can play as it is set."""
        return self.tasks

    def goes_on_from(self, other: "AgentParameters") -> str | None:
        """Why it can't go on from what another of its kind has learned; None where it can."""
        return None

    def unfit(self, field: str, other: "AgentParameters") -> str | None:
        """Why `other`, of a kind that the reference `field` may have, can't be what it names; None where it can."""
        return None

    @property
    def watched_steps(self) -> int:
        """The steps at its beginning in which it watches another agent and does not act itself."""
        return 0

    def learner_among(self, agents: "Mapping[str, AgentParameters]") -> "AgentParameters":
        """Those of the declared agents by whose parameters its table is learned while it is trained: its own."""
        return self

    def agent(self, setting: "Setting") -> Any:
        """A new agent in plain Python (`plain.PlainAgent`); of a compiled kind, which has the next three, nothing.

        Raises:
            NotImplementedError: the kind has neither.
        """
        raise NotImplementedError(f"{type(self).__name__} defines neither agent nor create, restore and save")

    def create(self, setting: "Setting") -> Any:
        """A new agent's record for `setting`."""
        return _plain().created(self, setting)

    def restore(self, setting: "Setting", saved: Saved) -> Any:
        """The record that goes on from what `save` gave, for `setting.steps` further steps."""
        return _plain().restored(self, setting, saved)

    @classmethod
    def compiled(cls) -> bool:
        """Whether it is a record and kernels, not an object in plain Python."""
        return cls.create is not AgentParameters.create

    @property
    def frozen(self) -> "Player":
        """Who plays as it does, greedy and without learning, from what it saved."""
        frozen: Player = _frozen_table()(self) if self.compiled() else _plain().FrozenPlain(self)
        return frozen

    def planning_every(self, record: Any, steps: int) -> Any:
        """The record that goes on with the same arrays and plans every so many steps; asked of one that `plans`."""
        return record._replace(plan_every=steps)

    def forget_rewards(self, record: Any) -> None:
        """Let a planner's record plan on with no rewards until a pair is tried again; nothing to others."""

    def pooled(self, setting: "Setting", several: Sequence[Saved], strength: float) -> Saved:
        """What `save` would give of one that knows what `several` have learned; asked of one that `pools`.

        `strength` is how many visits to a pair that counts as, at most.
        """
        raise NotImplementedError

    @property
    def forgets(self) -> bool:
        """Whether its counts may become fewer, so that they do not tell what it met since."""
        return False

    def taking_in_a_pool(self) -> Self:
        """The parameters with which one goes on from what `pooled` gave."""
        return self

    @property
    def is_told(self) -> bool:
        """Whether it makes something of being told that another human comes (`meet`)."""
        return False

    def meet(self, record: Any, human: int) -> None:
        """Be told that another human comes: at a visit's start, and where phases change it.

        Args:
            record: the agent's.
            human: its number among those of the cell, by when they come first. An agent that is to find out by
                itself leaves it alone.
        """

    def save(self, record: Any) -> Saved:
        """The arrays of a record, with their public names (`q`, `visits`, `reward_sums`, `successor_*`)."""
        saved: Saved = _plain().saved(self, record)
        return saved

    def values(self, saved: Saved) -> npt.NDArray[np.float64]:
        """What it believes each action is worth, shape (states, actions): what a visit is steered by, and drawn.

        An array that is called `q` is this and nothing else.
        """
        return saved["q"]

    def models(self, saved: Saved) -> dict[str, Saved]:
        """Its learned models of the world by name, each as `model_arrays` has it, the one it acts by first."""
        return {}

    def updates_a_step(self, setting: "Setting", saved: Saved) -> float | None:
        """How many values it changes a step in the end, on the average; None where it does not say."""
        return None if self.learns else 0.0

    def arrays(self, setting: "Setting") -> dict[str, Declared]:
        """What each array is that `save` gives, so that no file can hold another.

        Of a kind that does not say it: what those of a new agent are, any finite numbers, of any length where they
        are empty.
        """
        new = self.save(self.create(setting._replace(steps=1)))
        return {
            name: Declared(array.dtype.str, tuple(size or None for size in array.shape), *_limits(array.dtype))
            for name, array in new.items()
        }

    def fault(self, setting: "Setting", saved: Saved) -> str | None:
        """What is wrong with saved arrays taken together, each being as it was declared; None where nothing is."""
        return None


class Setting(NamedTuple):
    """Where an agent plays: `task`, the sizes of its tables, how many steps it may take, who else is declared."""

    task: str
    n_states: int
    n_actions: int
    steps: int
    agents: Mapping[str, AgentParameters] = {}
    seed: int = 0
    """The root of every random number, and the cell's path: what a stream of its own is made of."""
    cell: str = ""
    goals: int = 1
    """Of how many blocks of equal size its states are made up, one for each goal, in which the same actions lead on."""


class Player(Protocol):
    """What is asked of the parameters of one that goes on from what was saved."""

    def restore(self, setting: Setting, saved: Saved) -> Any:
        """As `AgentParameters` says, and so are the others."""

    def save(self, record: Any) -> Saved: ...  # noqa: D102

    def arrays(self, setting: Setting) -> dict[str, Declared]: ...  # noqa: D102

    def values(self, saved: Saved) -> npt.NDArray[np.float64]: ...  # noqa: D102

    def models(self, saved: Saved) -> dict[str, Saved]: ...  # noqa: D102

    def fault(self, setting: Setting, saved: Saved) -> str | None: ...  # noqa: D102


def _plain() -> Any:
    from visitlab_cli.agents import plain  # only now: it is made with what stands here

    return plain


def _frozen_table() -> Any:
    from visitlab_cli.agents.greedy_table import FrozenTable  # only now, as above

    return FrozenTable


def _choose(agent, state, step, random):  # type: ignore[no-untyped-def]
    """The action for `state` at the agent's `step` (from 1): `(action, explored)`, changing `random`."""


def _learn(agent, state, action, reward, next_state, end, step, random):  # type: ignore[no-untyped-def]
    """Learn from one transition, the agent's `step` (from 1), changing `random` where it draws.

    `end` says that the trial ends with it. The task goes on (no trial ends where the goal is reached), so a
    bootstrap need not be cut there; but `next_state` is not acted on, and the next call to `choose` is about the
    first state of another trial. What belongs to one trial, such as eligibility traces or an action drawn ahead,
    ends with it.
    """


def _tell(agent, columns, row):  # type: ignore[no-untyped-def]
    """Write what the log keeps of an agent that tells something of itself (`AgentParameters.parts`)."""


def _tell_nothing(agent, columns, row):  # type: ignore[no-untyped-def]
    pass


TELL = Operation(_tell, otherwise=_tell_nothing)
tell = TELL.function
CHOOSE = Operation(_choose)
LEARN = Operation(_learn)
choose = CHOOSE.function
learn = LEARN.function


def _choose_as(agent, state, meant, step, random):  # type: ignore[no-untyped-def]
    """`choose` where action a comes to `meant[a]`: it is valued, chosen and told as that."""


def _choose_any(agent, state, meant, step, random):  # type: ignore[no-untyped-def]
    return choose(agent, state, step, random)


CHOOSE_AS = Operation(_choose_as, otherwise=_choose_any)
"""Of a kind that `takes_masks`; a config refuses any other where a mask is asked for."""
choose_as = CHOOSE_AS.function


def _limits(dtype: np.dtype[Any]) -> tuple[float, float]:
    if dtype.kind not in "iu":
        return -LARGEST, LARGEST
    return int(np.iinfo(dtype).min), int(np.iinfo(dtype).max)


def zeros(setting: Setting) -> npt.NDArray[np.float64]:
    """A table of shape (states, actions)."""
    return np.zeros((setting.n_states, setting.n_actions))
