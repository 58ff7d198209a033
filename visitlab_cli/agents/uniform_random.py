"""The floor: every action with the same probability, nothing learned."""

from collections.abc import Mapping
from typing import ClassVar, Literal, NamedTuple

from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters, Saved, Setting, zeros
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.agents.exploration import Table
from visitlab_cli.random_numbers import RandomState, random_below
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class UniformRandom(NamedTuple):
    """`q`, shape (states, actions), is zero: as a visit's module it leaves every choice to chance."""

    q: Table


class RandomParameters(AgentParameters):
    """Uniformly random actions."""

    learns: ClassVar[bool] = False
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.23, GO_TO_HUMAN: 0.28, SOCIAL: 0.3, VISIT: 0.3}
    kind: Literal["random"]

    def create(self, setting: Setting) -> UniformRandom:
        """Nothing but the size of the table."""
        return UniformRandom(zeros(setting))

    def restore(self, setting: Setting, saved: Saved) -> UniformRandom:
        """Chance has no memory."""
        return self.create(setting)

    def save(self, record: UniformRandom) -> Saved:
        """A table of zeros, so that every model has one."""
        return {"q": record.q}

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """The table."""
        return {"q": floats(setting.n_states, setting.n_actions)}


@CHOOSE.of(UniformRandom)
def choose(agent: UniformRandom, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """Any action."""
    return random_below(random, agent.q.shape[1]), True


@LEARN.of(UniformRandom)
def learn(
    agent: UniformRandom,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Learn nothing."""
