"""What an experiment is to those who plan, run and tell of it: they ask it, and nobody asks of which kind it is."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.agents.exploration import Table
from visitlab_cli.config.names import Module
from visitlab_cli.settings import Settings
from visitlab_cli.world.columns import MODULES
from visitlab_cli.world.lab import Lab, paper_lab
from visitlab_cli.world.tasks import TASKS, Task


class Site(NamedTuple):
    """Where an experiment takes place: the lab, the human's record (None where there is none), distances, modules.

    `distances` are the four thresholds in cells; `tables` has the Q of each trained module, by its task.
    """

    lab: Lab
    human: Any
    distances: tuple[int, ...]
    tables: Mapping[str, Table]


class Experiment(Settings):
    """An experiment of a config; a subclass adds `task`, a Literal, its settings, and what differs from this."""

    planning_options: ClassVar[tuple[str, ...]] = ()
    """Settings that mean something only where the agent that acts plans."""

    task: str
    if TYPE_CHECKING:  # a field of each, in its own place and with its own default
        trial_steps: int

    @property
    def plays(self) -> Task:
        """The description of its task."""
        return TASKS[self.task]

    @property
    def assembled(self) -> bool:
        """Whether trained modules act as one in it, so that it trains no agents of its own."""
        return self.plays.has(MODULES)

    @property
    def counted_in(self) -> str:
        """What its length is declared in, `steps` or `trials`, and so its curves are over."""
        return "steps"

    @property
    def n_steps(self) -> int:
        """Steps of each of its cells."""
        raise NotImplementedError

    @property
    def n_trials(self) -> int:
        """Trials of each of its cells."""
        raise NotImplementedError

    @property
    def trained(self) -> tuple[str, ...]:
        """The names of the agents that it trains."""
        return ()

    @property
    def met(self) -> tuple[str, ...]:
        """The names of the humans that are met in it, each in a cell of its own."""
        return ()

    @property
    def starts(self) -> dict[str, Module]:
        """The trained modules that its cells start from, by the module's task."""
        return {}

    @property
    def steering(self) -> tuple[str, ...]:
        """Those of `starts`, by their tasks, whose values steer the robot here."""
        return ()

    @property
    def crossed(self) -> bool:
        """Whether each seed of its own meets each seed of the modules."""
        return False

    def seed_pairs(self, seeds: int) -> list[tuple[int, int]]:
        """The (own seed, modules' seed) of each cell."""
        return [(seed, seed) for seed in range(seeds)]

    def for_one_trial(self) -> Self:
        """The same with a single trial."""
        raise NotImplementedError

    def evaluated(self, trials: int | None, social: str) -> Self:
        """The same with another number of trials or another social module, where these are given."""
        return self

    def idle(self, agents: Mapping[str, AgentParameters]) -> tuple[str, ...]:
        """The settings that mean nothing as things stand, and so are not written."""
        return ()

    def with_whole_modules(self, experiments: "Mapping[str, Experiment]") -> Self:
        """The same with each module named in full, so that one setting has one spelling."""
        return self

    def task_in(self, site: Site) -> Any:
        """The task's record, for which `begin_trial`, `step` and `observe` are registered."""
        raise NotImplementedError

    def parameters_of(self, agent: AgentParameters) -> AgentParameters:
        """The parameters with which an agent plays here."""
        return agent

    def restored(self, agent: AgentParameters, setting: Setting, saved: Saved) -> Any:
        """The record of an agent that goes on here from what it saved."""
        return agent.restore(setting, saved)


def lab_of(settings: Experiment) -> Lab:
    """The lab that an experiment takes place in, and that the sizes of its modules are of."""
    return paper_lab()
