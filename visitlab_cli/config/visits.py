"""The visit as a config declares it: the three modules together lead a human through goal rooms."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, WithJsonSchema

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import LARGEST, Declared
from visitlab_cli.config.controller import Controller, options_of
from visitlab_cli.config.experiment import Experiment, InLab, Site
from visitlab_cli.config.goal_rooms import ALL, GoalRooms, numbered
from visitlab_cli.config.hidden import LEVELS, HiddenEngagement
from visitlab_cli.config.labs import LabSettings
from visitlab_cli.config.names import Module, ModuleName, Names, distinct, module
from visitlab_cli.config.phases import VisitPhases
from visitlab_cli.errors import ConfigError
from visitlab_cli.settings import SOME, WORD, Settings, since
from visitlab_cli.simulation.controller import LEAD, PLAN, make_planned
from visitlab_cli.simulation.estimates import RECENT
from visitlab_cli.simulation.visit import Visit as VisitTask
from visitlab_cli.simulation.visit import make_visit
from visitlab_cli.wording import cut, printable
from visitlab_cli.world.columns import BELIEF
from visitlab_cli.world.columns import PLAN as PLAN_PART
from visitlab_cli.world.lab import goals_of
from visitlab_cli.world.task import VISIT_TRIAL_STEPS
from visitlab_cli.world.tasks import GO_TO_HUMAN, NAVIGATION, SOCIAL
from visitlab_cli.world.visit import VisitWorld, make_visit_world


def _learns(given: Any) -> Any:
    names = tuple(given) if isinstance(given, list | tuple) else given
    if names not in ((SOCIAL,), (SOCIAL, NAVIGATION), (NAVIGATION, SOCIAL)):
        raise ValueError("must be [social] or [social, navigation]; nothing learns in visitlab eval --frozen")
    return (SOCIAL, NAVIGATION) if NAVIGATION in names else (SOCIAL,)


Learns = Annotated[
    tuple[Literal["social", "navigation"], ...],
    BeforeValidator(_learns),
    WithJsonSchema({"type": "array", "minItems": 1, "uniqueItems": True, "items": {"enum": [SOCIAL, NAVIGATION]}}),
]


class Pool(Settings):
    """A social module that begins with what several trainings have learned, as one: what humans have in common."""

    pool: Annotated[
        tuple[ModuleName, ...], Field(min_length=2, json_schema_extra={"uniqueItems": True}), AfterValidator(distinct)
    ] = Field(description="the trainings, experiment/agent/human, whose agents are of one kind; the same seed of each")
    prior_strength: float = Field(
        default=20, ge=1, le=LARGEST, description="as how many visits to a pair what they know of it counts, at most"
    )


def _form_of_social(given: Any) -> str:
    return SOME if isinstance(given, Mapping | Pool) else WORD


def _no_list(given: Any) -> Any:
    if isinstance(given, list | tuple):
        names = ", ".join(each if isinstance(each, str) else "..." for each in given)
        raise ValueError(f"must be one module, or several as one: {{pool: [{printable(cut(names))}]}}")
    return given


SocialModule = Annotated[
    Annotated[ModuleName, BeforeValidator(_no_list), Tag(WORD)] | Annotated[Pool, Tag(SOME)],
    Discriminator(_form_of_social),
]


class Modules(Settings):
    """The three trained modules that make a visit, each `experiment/agent` or `experiment/agent/human`."""

    navigation: ModuleName = Field(description="the navigation module, which says where the human should go")
    go_to_human: ModuleName = Field(description="the module that brings the robot in front of the human")
    social: SocialModule = Field(
        description="the social module, which decides and goes on learning; or {pool: [...], prior_strength: 20}, "
        "several as one, whose prior_strength is 20 if left out"
    )

    @property
    def pool(self) -> Pool | None:
        """The pool, where the social module is one."""
        return self.social if isinstance(self.social, Pool) else None

    @property
    def by_role(self) -> dict[str, str]:
        """Their names by the module's task; further ones of a pool by `social 2` and so on."""
        social = (self.social,) if isinstance(self.social, str) else self.social.pool
        further = {f"{SOCIAL} {number}": name for number, name in enumerate(social[1:], 2)}
        return {NAVIGATION: self.navigation, GO_TO_HUMAN: self.go_to_human, SOCIAL: social[0], **further}


class Visit(InLab, HiddenEngagement):
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
        default=ALL,
        description="rooms that goals are drawn from: all, or a list of at least two, as numbers, 0..8 row by row from "
        "the north-west in the paper's lab, or as letters",
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
    learns: Learns = Field(
        default=("social",),
        description="which modules go on learning: the social one, and navigation, for a controller that uses what it "
        "knows of moving",
        json_schema_extra=since("0.2.0"),
    )
    navigation_model: Literal["last_seen", "own"] = Field(
        default="last_seen",
        description="what navigation goes on with: where a move from a cell was last seen to end, or where most often, "
        "training included",
        json_schema_extra=since("0.2.0"),
    )
    phases: VisitPhases

    @property
    def options(self) -> tuple[str, ...]:
        """What the controller does otherwise than the paper's."""
        return options_of(self.controller)

    @property
    def parts(self) -> tuple[str, ...]:
        """The plan, where the controller leads by one, and the belief."""
        more = (*((PLAN_PART,) if LEAD in self.options else ()), *((BELIEF,) if self.believes else ()))
        return (*super().parts, *more)

    @property
    def played_as(self) -> str:
        """Planned, too, for all but the paper's controller; and by what is hidden."""
        planned = "planned" if self.options else ""
        return "-".join(filter(None, (super().played_as, planned, self.perceived_as)))

    @property
    def seconds_a_trial(self) -> float:
        """Eight sweeps of a lead plan every ten trials, where what it is made of has changed."""
        return 0.015 if LEAD in self.options else 0.0

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
        return {role: module(name) for role, name in self.modules.by_role.items()}

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

    @property
    def pooled(self) -> tuple[str, ...]:
        """As declared."""
        return tuple(role for role in self.starts if role not in self.steering) if self.modules.pool else ()

    def with_any_agent(self) -> Self:
        """Of its social module, or of all of a pool."""
        social = self.modules.social
        if isinstance(social, str):
            return self.with_social(module(social)._replace(agent="*").text)
        names = tuple(module(name)._replace(agent="*").text for name in social.pool)
        return self.with_social(social.model_copy(update={"pool": names}))

    def with_social(self, social: str | Pool) -> Self:
        """With another social module."""
        return self.model_copy(update={"modules": self.modules.model_copy(update={"social": social})})

    def idle(self, agents: Mapping[str, AgentParameters]) -> tuple[str, ...]:
        """Also the planning options where the social module does not plan; `told` where the controller does not."""
        untold: tuple[str, ...] = () if PLAN in self.options else ("told",)
        untold += () if NAVIGATION in self.learns else ("navigation_model",)
        plans = agents[self.starts[SOCIAL].agent].plans
        return (*super().idle(agents), *untold, *self.unsaid_of_engagement, *(() if plans else self.planning_options))

    def with_whole_modules(self, experiments: Mapping[str, Experiment]) -> Self:
        """With the human that each social module was trained with."""

        def whole(name: str) -> str:
            named = module(name)
            return name if named.human is not None else f"{name}/{experiments[named.experiment].met[0]}"

        social = self.modules.social
        if isinstance(social, str):
            return self.with_social(whole(social))
        return self.with_social(social.model_copy(update={"pool": tuple(map(whole, social.pool))}))

    def in_labs(self, labs: Mapping[str, LabSettings]) -> Self:
        """With the numbers of its goal rooms; in a lab other than the paper's all of them are told as `all`."""
        own = super().in_labs(labs)
        return own.model_copy(update={"goal_rooms": numbered(self.goal_rooms, self.lab_name, labs)})

    def task_in(self, site: Site) -> VisitTask:
        """The visit in the lab, with the Q of navigation and go_to_human."""
        world = self._world(site)
        tables = site.tables[NAVIGATION], site.tables[GO_TO_HUMAN]
        controller = None
        if self.options:
            if not site.models[NAVIGATION]:
                raise ConfigError(f"{self.modules.navigation} has learned no model of moving; the controller needs one")
            told = (site.told.p_S, site.told.p_A) if self.told else None
            window = RECENT if len({phase.met for phase in self.phases}) > 1 else 0
            worlds = [self._world(site._replace(lab=lab)) for lab in dict.fromkeys(self.labs)]
            model, reach = site.models[NAVIGATION], site.distances[-1]
            learns = self.navigation_model if NAVIGATION in self.learns else None
            controller = make_planned(self.options, world, model, reach, told, window, worlds, learns)
        return make_visit(world, *tables, self.trial_steps, self.social_reward, controller)

    def _world(self, site: Site) -> VisitWorld:
        """A lab with the human, and those of the goal rooms that can be reached there, all unless some are named."""
        goals = [room for room in goals_of(site.lab) if self.goal_rooms == ALL or room in self.goal_rooms]
        perception = self.perception(site.told, site.kept)
        return make_visit_world(site.human, goals, site.distances, site.lab, perception)

    def going_on(self, task: VisitTask, other: VisitTask) -> VisitTask:
        """The controller goes on, with what it knows and plans, unless it is told of each human; and the belief."""
        world = other.world._replace(perception=task.world.perception) if self.learns_belief else other.world
        return (other if self.told else task)._replace(world=world)

    @property
    def hidden(self) -> bool:
        """As it is observed."""
        return self.observe != LEVELS

    def declared_kept(self) -> Mapping[str, Declared]:
        """As a belief has them."""
        return self.declared_belief()

    def kept_by(self, task: VisitTask) -> Saved:
        """What is believed of the human."""
        return self.kept_of(task.world.perception)

    def frozen(self) -> Self:
        """Neither navigation learns anything, nor a belief about the human."""
        return self.learned().model_copy(update={"learns": (SOCIAL,)})

    def parameters_of(self, agent: AgentParameters) -> AgentParameters:
        """Those of the social module, which plans as often as the visit says."""
        taking = agent.taking_in_a_pool() if self.modules.pool else agent
        return taking.model_copy(update={"plan_every": self.plan_every}) if agent.plans else taking

    def begun_with(self, agent: AgentParameters, setting: Setting, saved: Mapping[str, Saved]) -> Saved:
        """Those of the social module, or of its pool as one; what was believed of a human is the first one's."""
        pool = self.modules.pool
        if pool is None:
            return saved[SOCIAL]
        several = [saved[role] for role in self.pooled]
        return {**saved[SOCIAL], **agent.pooled(setting, several, pool.prior_strength)}

    def restored(self, agent: AgentParameters, setting: Setting, saved: Saved) -> Any:
        """The social module, which meets somebody new and may begin with no rewards to plan with."""
        record = agent.restore(setting, saved)
        agent.meet(record, 0)
        if self.planner_rewards == "restart":
            agent.forget_rewards(record)
        return record
