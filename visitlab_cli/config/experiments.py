"""The experiments of a config: three trainings, and the visit, told apart by `task`."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, field_validator

from visitlab_cli.agents.base import AgentParameters, Saved
from visitlab_cli.agents.declared import Declared
from visitlab_cli.config.experiment import Experiment, InLab, Site
from visitlab_cli.config.hidden import LEVELS, HiddenEngagement
from visitlab_cli.config.names import Module, ModuleName, Names, module
from visitlab_cli.config.phases import ModulePhases, SocialPhases, TrainingPhases
from visitlab_cli.config.visits import Visit
from visitlab_cli.humans.base import Probability
from visitlab_cli.world.columns import BELIEF
from visitlab_cli.world.go_to_human import GoToHuman, make_go_to_human
from visitlab_cli.world.navigation import Navigation, make_navigation
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE, Social, make_social
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS
from visitlab_cli.world.tasks import SOCIAL

MOST_STEPS = 10**12
TRAINING_STEPS = 500_000


class Training(Experiment):
    """What the three trainings share: agents, each of which plays alone, and how long."""

    agents: Names = Field(description="the agents that are trained, each on its own")
    trial_steps: int = Field(default=TRAINING_TRIAL_STEPS, ge=1, le=10**6, description="steps in a trial")
    steps: int = Field(
        default=TRAINING_STEPS, ge=1, le=MOST_STEPS, description="steps of training; a whole number of trials"
    )
    phases: TrainingPhases

    @field_validator("steps")
    @classmethod
    def _whole_trials(cls, steps: int, info: ValidationInfo) -> int:
        trial_steps = info.data.get("trial_steps", 1)  # absent where it is itself wrong
        rest = steps % trial_steps
        if rest:
            near = [str(n) for n in (steps - rest, steps - rest + trial_steps) if n]
            trials = f"a whole number of trials of {trial_steps} steps"
            raise ValueError(f"must be {trials}, such as {' or '.join(near)} (got {steps})")
        return steps

    @property
    def replaced_by_phases(self) -> tuple[str, ...]:
        """Its steps."""
        return ("steps",)

    @property
    def declared_trials(self) -> int:
        """As many as the steps make."""
        return self.steps // self.trial_steps

    @property
    def trained(self) -> tuple[str, ...]:
        """As declared."""
        return self.agents

    def with_trials(self, trials: int) -> Self:
        """Its steps are so many trials'."""
        return self.model_copy(update={"steps": trials * self.trial_steps, "phases": ()})


class NavigationTraining(Training, InLab):
    """Learn to reach each of the nine rooms and to stay there; no human."""

    task: Literal["navigation"]
    phases: ModulePhases

    def task_in(self, site: Site) -> Navigation:
        """Navigation in the lab."""
        return make_navigation(self.trial_steps, site.lab)


class GoToHumanTraining(Training, InLab):
    """Learn to get in front of a human who stands still."""

    task: Literal["go_to_human"]
    phases: ModulePhases
    success: Literal["facing", "seen"] = Field(
        default="facing", description="what is rewarded: being faced by the human, or only seen"
    )

    def task_in(self, site: Site) -> GoToHuman:
        """In the lab."""
        return make_go_to_human(self.trial_steps, self.success, site.distances, site.lab)


class SocialTraining(Training, HiddenEngagement):
    """Learn to win a human's attention and to lead it in a desired direction."""

    task: Literal["social"]
    phases: SocialPhases
    humans: Names = Field(default=(), validate_default=False, description="the humans, each met by an agent of its own")
    arena: int = Field(default=ARENA, ge=2, le=10_000, description="side of the square world, in cells")
    direction_change: Probability = Field(
        default=DIRECTION_CHANGE, description="probability that the desired direction is redrawn after a step"
    )
    start_from: ModuleName | None = Field(
        default=None,
        validate_default=False,  # None, which nobody may write
        description="the trained module, `experiment/agent/human`, that each agent goes on learning from, the same "
        "seed's; left out: it starts with nothing learned",
    )

    @field_validator("start_from", mode="before")
    @classmethod
    def _named(cls, start_from: Any) -> Any:
        if start_from is None:  # that it starts with nothing has one spelling, so that it has one hash
            raise ValueError("must be experiment/agent/human; leave it out to start with nothing learned")
        return start_from

    @property
    def replaced_by_phases(self) -> tuple[str, ...]:
        """Its steps and its human."""
        return "humans", "steps"

    @property
    def starts(self) -> dict[str, Module]:
        """The module that it goes on from, if it does."""
        return {} if self.start_from is None else {SOCIAL: module(self.start_from)}

    def idle(self, agents: Mapping[str, AgentParameters]) -> tuple[str, ...]:
        """Also `start_from` where it starts with nothing, and a belief where there is none."""
        unsaid = (*(("start_from",) if self.start_from is None else ()), *self.unsaid_of_engagement)
        return (*super().idle(agents), *unsaid)

    @property
    def parts(self) -> tuple[str, ...]:
        """Also the belief."""
        return (*super().parts, *((BELIEF,) if self.believes else ()))

    @property
    def played_as(self) -> str:
        """Also by what is hidden."""
        return "-".join(filter(None, (super().played_as, self.perceived_as)))

    def task_in(self, site: Site) -> Social:
        """In an arena of its own."""
        perception = self.perception(site.told, site.kept)
        return make_social(site.human, self.trial_steps, self.arena, self.direction_change, site.distances, perception)

    def going_on(self, task: Social, other: Social) -> Social:
        """A belief that learns goes on."""
        return other._replace(perception=task.perception) if self.learns_belief else other

    @property
    def hidden(self) -> bool:
        """As it is observed."""
        return self.observe != LEVELS

    def declared_kept(self) -> Mapping[str, Declared]:
        """As a belief has them."""
        return self.declared_belief()

    def kept_by(self, task: Social) -> Saved:
        """What is believed of the human."""
        return self.kept_of(task.perception)


AnyExperiment = Annotated[NavigationTraining | GoToHumanTraining | SocialTraining | Visit, Field(discriminator="task")]
