"""A Q-learner that first watches another agent play, then acts alone and goes on learning (paper, section 5.2)."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field

from visitlab_cli.agents.base import CHOOSE, LEARN, AgentParameters, Saved, Setting
from visitlab_cli.agents.base import choose as choose_of
from visitlab_cli.agents.base import learn as learn_of
from visitlab_cli.agents.declared import Declared
from visitlab_cli.agents.q_learning import QLearning, QLearningParameters
from visitlab_cli.random_numbers import RandomState
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL, VISIT


class Observer(NamedTuple):
    """`learner` (while watching) and `acting` (alone) share one table."""

    watched: Any
    learner: QLearning
    acting: QLearning
    until: int


class ObserverParameters(AgentParameters):
    """Learns from every transition of the agent it watches until step `until`, then acts by what it learned."""

    references: ClassVar[dict[str, tuple[str, ...]]] = {
        "watches": (),
        "learner": ("q_learning",),
        "acts_as": ("q_learning",),
    }
    takes_masks: ClassVar[bool] = True
    microseconds_a_step: ClassVar[Mapping[str, float]] = {NAVIGATION: 0.38, GO_TO_HUMAN: 0.32, SOCIAL: 0.5, VISIT: 0.38}
    kind: Literal["observer"]
    watches: str = Field(description="the agent that plays until then")
    learner: str = Field(description="the q_learning agent that learns from it")
    until: int = Field(ge=0, le=10**12, description="steps that it watches; they count as steps of the experiment")
    acts_as: str = Field(description="the q_learning agent whose parameters it acts and learns with alone")

    def unfit(self, field: str, other: AgentParameters) -> str | None:
        """Its own table is of all states, as the watched agent meets them."""
        return "must not be symmetric" if field != "watches" and getattr(other, "symmetric", False) else None

    @property
    def watched_steps(self) -> int:
        """As declared."""
        return self.until

    def learner_among(self, agents: Mapping[str, AgentParameters]) -> AgentParameters:
        """The learner's, by which it begins."""
        return agents[self.learner]

    def create(self, setting: Setting) -> Observer:
        """A new watched agent beside a new table."""
        learner, acting = self._q_learners(setting)
        record = learner.create(setting)
        watched = setting.agents[self.watches].create(setting)
        return Observer(watched, record, acting.with_table(record.q, record.visits), self.until)

    def restore(self, setting: Setting, saved: Saved) -> QLearning:
        """Alone with its table: there is nobody left to watch."""
        record: QLearning = self._q_learners(setting)[1].restore(setting, saved)
        return record

    def _q_learners(self, setting: Setting) -> tuple[QLearningParameters, QLearningParameters]:
        learner, acting = setting.agents[self.learner], setting.agents[self.acts_as]
        assert isinstance(learner, QLearningParameters)
        assert isinstance(acting, QLearningParameters)
        return learner, acting

    def save(self, record: Observer | QLearning) -> Saved:
        """The table and how often each pair was updated."""
        table = record.learner if isinstance(record, Observer) else record
        return {"q": table.q, "visits": table.visits}

    def updates_a_step(self, setting: Setting, saved: Saved) -> float:
        """As the agent that it becomes."""
        return self._q_learners(setting)[1].updates_a_step(setting, saved)

    def arrays(self, setting: Setting) -> dict[str, Declared]:
        """Those of the agent that it becomes."""
        return self._q_learners(setting)[1].arrays(setting)


@CHOOSE.of(Observer)
def choose(agent: Observer, state: int, step: int, random: RandomState) -> tuple[int, bool]:
    """The watched agent's choice, then its own."""
    if step <= agent.until:
        return choose_of(agent.watched, state, step, random)  # type: ignore[no-any-return]
    return choose_of(agent.acting, state, step, random)  # type: ignore[no-any-return]


@LEARN.of(Observer)
def learn(
    agent: Observer,
    state: int,
    action: int,
    reward: float,
    next_state: int,
    end: bool,
    step: int,
    random: RandomState,
) -> None:
    """Both learn from the watched agent's step; later only the learner, from its own."""
    if step <= agent.until:
        learn_of(agent.watched, state, action, reward, next_state, end, step, random)
        learn_of(agent.learner, state, action, reward, next_state, end, step, random)
    else:
        learn_of(agent.acting, state, action, reward, next_state, end, step, random)
