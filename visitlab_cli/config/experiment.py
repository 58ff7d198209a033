"""What an experiment is to those who plan, run and tell of it: they ask it, and nobody asks of which kind it is."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Self

from pydantic import Field, PrivateAttr

from visitlab_cli.agents.base import AgentParameters, Saved, Setting
from visitlab_cli.agents.declared import Declared
from visitlab_cli.agents.exploration import Table
from visitlab_cli.config.labs import LabSettings, lab_called
from visitlab_cli.config.names import PAPER_LAB, Module, Name, changes_of_place
from visitlab_cli.config.phases import PHASES, Phase
from visitlab_cli.settings import Settings, since
from visitlab_cli.world.columns import DOORS, ENGAGEMENT, MODULES
from visitlab_cli.world.columns import PHASES as PHASES_PART
from visitlab_cli.world.lab import Lab
from visitlab_cli.world.sight import Doors, Walls
from visitlab_cli.world.tasks import SOCIAL, TASKS, Task


class Site(NamedTuple):
    """Where an experiment takes place: the lab, the human's record (None where there is none), distances, modules.

    `distances` are the four thresholds in cells; `tables` has the Q of each trained module that steers, by its task,
    `models` what each has learned of the world, empty where it has no model. `told` is what the config says of the
    human, for an experiment that is told it; `kept` what the social module that it starts from has saved.
    """

    lab: Lab
    human: Any
    distances: tuple[int, ...]
    tables: Mapping[str, Table]
    models: Mapping[str, Saved] = {}
    told: Any = None
    kept: Saved = {}


class Experiment(Settings):
    """An experiment of a config; a subclass adds `task`, a Literal, its settings, and what differs from this."""

    planning_options: ClassVar[tuple[str, ...]] = ()
    """Settings that mean something only where the agent that acts plans."""

    task: str
    if TYPE_CHECKING:  # a field of each, in its own place and with its own default
        trial_steps: int
        phases: tuple[Phase, ...]

    _labs: Mapping[str, LabSettings] = PrivateAttr(default={})

    @property
    def lab_name(self) -> str:
        """The name of the lab that it takes place in, and that the sizes of its modules are of."""
        return str(getattr(self, "lab", PAPER_LAB))

    @property
    def lab_names(self) -> set[str]:
        """The names of all labs that its cells know."""
        return {self.lab_name, *filter(None, (getattr(phase, "lab", None) for phase in self.phases))}

    def in_labs(self, labs: Mapping[str, LabSettings]) -> Self:
        """The same, knowing the labs that its config declares, with rooms by their numbers in its own."""
        own = self.model_copy()
        own._labs = labs
        return own

    def lab_in(self, phase: Phase | None = None) -> Lab:
        """The lab that it takes place in, or one of its phases does."""
        name, doors = getattr(phase, "lab", None), getattr(phase, "doors", None)
        return lab_called(name or self.lab_name, self._labs, doors)

    @property
    def labs(self) -> list[Lab]:
        """The labs that it takes place in: one, or that of each phase."""
        return [self.lab_in(phase) for phase in self.phases] or [self.lab_in()]

    @property
    def changes_of_place(self) -> list[str]:
        """Of each phase what of its lab and doors is another than in the phase before, in words."""
        said = ((getattr(phase, "lab", None), getattr(phase, "doors", None)) for phase in self.phases)
        return changes_of_place(self.lab_name, [(lab or self.lab_name, doors or {}) for lab, doors in said])

    @property
    def plays(self) -> Task:
        """The description of its task."""
        return TASKS[self.task]

    @property
    def parts(self) -> tuple[str, ...]:
        """What its cells have beside what its task has, of `SOME_CELLS`."""
        toggle = any(getattr(phase, "doors", None) for phase in self.phases)
        return (*((PHASES_PART,) if self.phases else ()), *((DOORS,) if toggle else ()))

    def going_on(self, task: Any, other: Any) -> Any:
        """The task with another human, `other`, in which what `task`, the first one, keeps for itself goes on."""
        return other

    @property
    def played_as(self) -> str:
        """What of its settings decides the types that its loop is compiled for; empty by default."""
        return "-".join(dict.fromkeys(filter(None, (_type_of(lab) for lab in self.labs))))

    @property
    def assembled(self) -> bool:
        """Whether trained modules act as one in it, so that it trains no agents of its own."""
        return self.plays.has(MODULES)

    @property
    def hidden(self) -> bool:
        """Whether engagement is hidden from the robot."""
        return False

    @property
    def seconds_a_trial(self) -> float:
        """What a trial costs beside its steps, on one core; for the estimate before a run."""
        return 0.0

    @property
    def counted_in(self) -> str:
        """What its length is declared in, `steps` or `trials`, and so its curves are over."""
        return "steps"

    @property
    def replaced_by_phases(self) -> tuple[str, ...]:
        """The settings that phases stand in place of."""
        raise NotImplementedError

    @property
    def declared_trials(self) -> int:
        """Its trials where there are no phases."""
        raise NotImplementedError

    @property
    def phase_trials(self) -> tuple[int, ...]:
        """The trials of each phase; none where there are no phases."""
        return tuple(phase.length(self.trial_steps) for phase in self.phases)

    @property
    def n_trials(self) -> int:
        """Trials of each of its cells."""
        return sum(self.phase_trials) if self.phases else self.declared_trials

    @property
    def n_steps(self) -> int:
        """Steps of each of its cells."""
        return self.n_trials * self.trial_steps

    @property
    def trained(self) -> tuple[str, ...]:
        """The names of the agents that it trains."""
        return ()

    @property
    def met(self) -> tuple[str, ...]:
        """The names of the humans that are met in it, each in a cell of its own; `phases` where they are in turn."""
        if not self.plays.has(ENGAGEMENT):
            return ()
        return (PHASES,) if self.phases else tuple(getattr(self, "humans", ()))

    def humans_met(self, name: str) -> tuple[str, ...]:
        """The humans of a cell by its one of `met`, each once, in the order in which they are met; '' has none."""
        if name != PHASES or not self.phases:
            return (name,) if name else ()
        return tuple(dict.fromkeys(phase.met for phase in self.phases))

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
        """The same with a single trial, or one in each phase."""
        if not self.phases:
            return self.with_trials(1)
        return self.model_copy(update={"phases": tuple(phase.for_one_trial() for phase in self.phases)})

    def with_trials(self, trials: int) -> Self:
        """The same with so many trials and no phases."""
        raise NotImplementedError

    @property
    def pooled(self) -> tuple[str, ...]:
        """Those of `starts`, by their roles, that its agent begins with as one; none where there is no pool."""
        return ()

    def with_any_agent(self) -> Self:
        """What visits share that differ in whose social module plays: the same with `*` for its agent."""
        return self

    def with_social(self, social: Any) -> Self:
        """The same with another social module, where it has one."""
        return self

    def evaluated(self, trials: int | None, social: str, humans: Sequence[str] = ()) -> Self:
        """The same with other trials, another social module, with these `humans` and so without phases, where given."""
        found = self.with_social(social) if social else self
        if self.phases and not humans:  # they say their trials
            return found
        if trials is None and not self.phases:
            return found
        return found.with_trials(self.n_trials if trials is None else trials)

    def idle(self, agents: Mapping[str, AgentParameters]) -> tuple[str, ...]:
        """The settings that mean nothing as things stand, and so are not written."""
        return self.replaced_by_phases if self.phases else (PHASES,)

    def with_whole_modules(self, experiments: "Mapping[str, Experiment]") -> Self:
        """The same with each module named in full, so that one setting has one spelling."""
        return self

    def frozen(self) -> Self:
        """The same where nothing is learned any more."""
        return self

    def task_in(self, site: Site) -> Any:
        """The task's record, for which `begin_trial`, `step` and `observe` are registered."""
        raise NotImplementedError

    def declared_kept(self) -> Mapping[str, Declared]:
        """What each array of `kept_by` must be."""
        return {}

    def kept_by(self, task: Any) -> Saved:
        """What its task has learned beside the agent, as arrays that are saved with the agent's."""
        return {}

    def parameters_of(self, agent: AgentParameters) -> AgentParameters:
        """The parameters with which an agent plays here."""
        return agent

    def begun_with(self, agent: AgentParameters, setting: Setting, saved: Mapping[str, Saved]) -> Saved:
        """The arrays that the agent goes on from here, of those of the modules of `starts`."""
        return saved[SOCIAL]

    def restored(self, agent: AgentParameters, setting: Setting, saved: Saved) -> Any:
        """The record of an agent that goes on here from what it saved."""
        return agent.restore(setting, saved)


def _type_of(lab: Lab) -> str:
    """What tells the types of its record from those of an open lab."""
    return ("doors" if isinstance(lab.doors, Doors) else "walls") if isinstance(lab.walls, Walls) else ""


class InLab(Experiment):
    """What takes place in a lab that may be chosen."""

    lab: Name = Field(
        default=PAPER_LAB,
        description="where it takes place: one of `labs`, or the paper's lab",
        json_schema_extra=since("0.2.0"),
    )


def lab_of(settings: Experiment) -> Lab:
    """The lab that an experiment takes place in, and that the sizes of its modules are of."""
    return settings.lab_in()
