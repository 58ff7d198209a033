"""The experiments of a config: three trainings and the visit, told apart by `task`."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, ValidationInfo, field_validator

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.config.controller import Controller, options_of
from visitlab_cli.config.experiment import Experiment, Site
from visitlab_cli.config.goal_rooms import N_ROOMS, GoalRooms
from visitlab_cli.config.names import Module, ModuleName, Names, module
from visitlab_cli.config.phases import SocialPhases, TrainingPhases, VisitPhases
from visitlab_cli.errors import ConfigError
from visitlab_cli.humans.base import Probability
from visitlab_cli.settings import Settings, since
from visitlab_cli.simulation.controller import LEAD, PLAN, make_planned
from visitlab_cli.simulation.estimates import RECENT
from visitlab_cli.simulation.visit import Visit as VisitTask
from visitlab_cli.simulation.visit import make_visit
from visitlab_cli.world.columns import PLAN as PLAN_PART
from visitlab_cli.world.go_to_human import GoToHuman, make_go_to_human
from visitlab_cli.world.navigation import Navigation, make_navigation
from visitlab_cli.world.social import ARENA, DIRECTION_CHANGE, Social, make_social
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS, VISIT_TRIAL_STEPS
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL
from visitlab_cli.world.visit import make_visit_world

MODULE_TASKS = (NAVIGATION, GO_TO_HUMAN, SOCIAL)
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


class NavigationTraining(Training):
    """Learn to reach each of the nine rooms and to stay there; no human."""

    task: Literal["navigation"]

    def task_in(self, site: Site) -> Navigation:
        """Navigation in the lab."""
        return make_navigation(self.trial_steps, site.lab)


class GoToHumanTraining(Training):
    """Learn to get in front of a human who stands still."""

    task: Literal["go_to_human"]
    success: Literal["facing", "seen"] = Field(
        default="facing", description="what is rewarded: being faced by the human, or only seen"
    )

    def task_in(self, site: Site) -> GoToHuman:
        """In the lab."""
        return make_go_to_human(self.trial_steps, self.success, site.distances, site.lab)


class SocialTraining(Training):
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
        """Also `start_from` where it starts with nothing."""
        return (*super().idle(agents), *(("start_from",) if self.start_from is None else ()))

    def task_in(self, site: Site) -> Social:
        """In an arena of its own."""
        return make_social(site.human, self.trial_steps, self.arena, self.direction_change, site.distances)


class Modules(Settings):
    """The three trained modules that make a visit, each `experiment/agent` or `experiment/agent/human`."""

    navigation: ModuleName = Field(description="the navigation module, which says where the human should go")
    go_to_human: ModuleName = Field(description="the module that brings the robot in front of the human")
    social: ModuleName = Field(description="the social module, which decides and goes on learning")


class Visit(Experiment):
    """The global task (paper, Fig. 5): the three modules together lead a human through goal rooms."""

    planning_options: ClassVar[tuple[str, ...]] = ("plan_every", "planner_rewards")

    task: Literal["visit"]
    modules: Modules = Field(description="which trained modules play")
    humans: Names = Field(
        default=(), validate_default=False, description="the humans that are visited, each by a copy of the modules"
    )
    trials: int = Field(default=1000, ge=1, le=10**9, description="trials of a visit")
    trial_steps: int = Field(default=VISIT_TRIAL_STEPS, ge=1, le=10**6, description="steps in a trial")
    plan_every: int = Field(
        default=100,
        ge=1,
        le=10**9,
        description="steps between two sweeps of the social module, which goes on learning",
    )
    models: Literal["paired", "first", "crossed"] = Field(
        default="paired",
        description="visit seed i uses the modules of training seed i (paired), of seed 0 (first), or of "
        "each seed (crossed)",
    )
    goal_rooms: GoalRooms = Field(
        default=tuple(range(N_ROOMS)),
        description="rooms that goals are drawn from: all, or a list of at least two, 0..8 row by row from "
        "the north-west",
    )
    planner_rewards: Literal["carried", "restart"] = Field(
        default="carried",
        description="whether the social planner starts with the rewards it learned in training or with none",
    )
    social_reward: Literal["social", "none"] = Field(
        default="social", description="what the social module learns from during the visit"
    )
    controller: Controller = Field(
        default="paper",
        description="what is done otherwise than in the paper (Fig. 5): route, mask and plan, one or several; or lead, "
        "which implies them",
        json_schema_extra=since("0.2.0"),
    )
    told: bool = Field(
        default=False,
        description="whether a controller that plans is told the human's p_S and p_A; else it estimates them",
        json_schema_extra=since("0.2.0"),
    )
    phases: VisitPhases

    @property
    def options(self) -> tuple[str, ...]:
        """What the controller does otherwise than the paper's."""
        return options_of(self.controller)

    @property
    def parts(self) -> tuple[str, ...]:
        """The plan, where the controller leads by one."""
        return (*super().parts, *((PLAN_PART,) if LEAD in self.options else ()))

    @property
    def played_as(self) -> str:
        """Planned, for all but the paper's controller."""
        return "planned" if self.options else ""

    @property
    def counted_in(self) -> str:
        """Trials, in which a visit tells all."""
        return "trials"

    @property
    def replaced_by_phases(self) -> tuple[str, ...]:
        """Its trials and its human."""
        return "humans", "trials"

    @property
    def declared_trials(self) -> int:
        """As declared."""
        return self.trials

    @property
    def starts(self) -> dict[str, Module]:
        """The three modules."""
        return {task: module(getattr(self.modules, task)) for task in MODULE_TASKS}

    @property
    def steering(self) -> tuple[str, ...]:
        """All but the social module, which acts itself."""
        return NAVIGATION, GO_TO_HUMAN

    @property
    def crossed(self) -> bool:
        """As declared."""
        return self.models == "crossed"

    def seed_pairs(self, seeds: int) -> list[tuple[int, int]]:
        """By `models`."""
        if self.crossed:
            return [(seed, model) for model in range(seeds) for seed in range(seeds)]
        return [(seed, 0 if self.models == "first" else seed) for seed in range(seeds)]

    def with_trials(self, trials: int) -> Self:
        """So many trials."""
        return self.model_copy(update={"trials": trials, "phases": ()})

    def with_social(self, social: str) -> Self:
        """With another social module."""
        return self.model_copy(update={"modules": self.modules.model_copy(update={"social": social})})

    def idle(self, agents: Mapping[str, AgentParameters]) -> tuple[str, ...]:
        """Also the planning options where the social module does not plan; `told` where the controller does not."""
        untold = () if PLAN in self.options else ("told",)
        plans = agents[self.starts[SOCIAL].agent].plans
        return (*super().idle(agents), *untold, *(() if plans else self.planning_options))

    def with_whole_modules(self, experiments: Mapping[str, Experiment]) -> Self:
        """With the human that the social module was trained with."""
        social = self.starts[SOCIAL]
        if social.human is not None:
            return self
        return self.with_social(f"{self.modules.social}/{experiments[social.experiment].met[0]}")

    def task_in(self, site: Site) -> VisitTask:
        """The visit in the lab, with the Q of navigation and go_to_human."""
        world = make_visit_world(site.human, self.goal_rooms, site.distances, site.lab)
        tables = site.tables[NAVIGATION], site.tables[GO_TO_HUMAN]
        controller = None
        if self.options:
            if not site.models[NAVIGATION]:
                raise ConfigError(f"{self.modules.navigation} has learned no model of moving; the controller needs one")
            told = (site.told.p_S, site.told.p_A) if self.told else None
            window = RECENT if len({phase.met for phase in self.phases}) > 1 else 0
            controller = make_planned(self.options, world, site.models[NAVIGATION], site.distances[-1], told, window)
        return make_visit(world, *tables, self.trial_steps, self.social_reward, controller)

    def going_on(self, task: VisitTask, other: VisitTask) -> VisitTask:
        """The controller goes on, with what it knows and plans, unless it is told of each human."""
        return other if self.told else task._replace(world=other.world)

    def parameters_of(self, agent: AgentParameters) -> AgentParameters:
        """Those of the social module, which plans as often as the visit says."""
        return agent.model_copy(update={"plan_every": self.plan_every}) if agent.plans else agent

    def restored(self, agent: AgentParameters, setting: Setting, saved: Saved) -> Any:
        """The social module, which may begin with no rewards to plan with."""
        record = agent.restore(setting, saved)
        if self.planner_rewards == "restart":
            agent.forget_rewards(record)
        return record


AnyExperiment = Annotated[NavigationTraining | GoToHumanTraining | SocialTraining | Visit, Field(discriminator="task")]
