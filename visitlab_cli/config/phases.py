"""The phases of an experiment: stretches of trials that one agent lives through, each with its own human and lab."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Self

from pydantic import Field, SerializerFunctionWrapHandler, field_validator, model_serializer, model_validator

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.config.labs import Door
from visitlab_cli.config.names import Name
from visitlab_cli.humans.base import Probability
from visitlab_cli.settings import Settings, since
from visitlab_cli.wording import or_else
from visitlab_cli.world.columns import ENGAGEMENT
from visitlab_cli.yaml.problems import Issue, Path

PHASES = "phases"
"""What stands for a human's name where the human changes: in paths, tables and references."""
MOST_PHASES = 100
UNSAID: Any = None
"""What a phase leaves out, and nobody may write."""


class Phase(Settings):
    """What every phase may say; what it leaves out is the experiment's."""

    trials: int = Field(default=UNSAID, validate_default=False, ge=1, le=10**9, description="trials of this phase")
    plan_every: int = Field(
        default=UNSAID,
        validate_default=False,
        ge=1,
        le=10**9,
        description="steps between two sweeps in this phase; left out: as without phases",
    )

    @model_serializer(mode="wrap")
    def _said(self, whole: SerializerFunctionWrapHandler) -> dict[str, Any]:
        return {name: value for name, value in whole(self).items() if value is not None}

    def __hash__(self) -> int:
        """Of all that it says; `doors` are a mapping."""
        return hash(self.model_dump_json())

    @property
    def met(self) -> str:
        """The name of its human; empty where the task has none."""
        return str(getattr(self, "human", ""))

    def length(self, trial_steps: int) -> int:
        """Its number of trials, which have so many steps each."""
        return self.trials

    def for_one_trial(self) -> Self:
        """The same with a single trial."""
        return self.model_copy(update={"trials": 1})


class TrainingPhase(Phase):
    """A phase of a training: as long as its `steps` or `trials` say."""

    steps: int = Field(
        default=UNSAID,
        validate_default=False,
        ge=1,
        le=10**12,
        description="steps of this phase, a whole number of trials; or say trials",
    )

    @model_validator(mode="after")
    def _one_length(self) -> Self:
        if (self.steps is None) == (self.trials is None):
            raise ValueError("must have steps or trials, one of the two")
        return self

    def length(self, trial_steps: int) -> int:
        """By its steps, where it says these."""
        return self.trials if self.steps is None else self.steps // trial_steps

    def for_one_trial(self) -> Self:
        """The same with a single trial."""
        return self.model_copy(update={"trials": 1, "steps": None})


class InLabPhase(Phase):
    """A phase of what takes place in a lab."""

    lab: Name = Field(
        default=UNSAID,
        validate_default=False,
        description="the lab in this phase, of the same cells and rooms; left out: the experiment's",
    )
    doors: dict[Door, Probability] = Field(
        default=UNSAID,
        validate_default=False,
        min_length=1,
        description="how likely each of some doors is opened or shut before a trial, the first included, as in "
        "{BE: 0.005}",
    )

    @field_validator("doors")
    @classmethod
    def _in_order(cls, doors: dict[str, float]) -> dict[str, float]:
        return dict(sorted(doors.items()))


class ModulePhase(TrainingPhase, InLabPhase):
    """A phase of a training in a lab."""


class SocialPhase(TrainingPhase):
    """A phase of a training with a human."""

    human: Name = Field(description="the human that is met in this phase")


class VisitPhase(InLabPhase):
    """A phase of a visit."""

    trials: int = Field(ge=1, le=10**9, description="trials of this phase")
    human: Name = Field(description="the human that is visited in this phase")


_Several = Field(
    default=(),
    min_length=1,
    max_length=MOST_PHASES,
    validate_default=False,
    description="what one agent lives through, one phase after the other; stands in place of humans, trials and steps",
    json_schema_extra=since("0.2.0"),
)
TrainingPhases = Annotated[tuple[TrainingPhase, ...], _Several]
ModulePhases = Annotated[tuple[ModulePhase, ...], _Several]
SocialPhases = Annotated[tuple[SocialPhase, ...], _Several]
VisitPhases = Annotated[tuple[VisitPhase, ...], _Several]


def wrong_phases(
    path: Path, experiment: Any, humans: Mapping[str, Any], players: Sequence[AgentParameters]
) -> Iterator[Issue]:
    """What is wrong with how an experiment says its phases, or its humans where it has none.

    Args:
        path: the experiment's.
        experiment: one that is right in itself.
        humans: those that are declared, by name.
        players: the agents that act in it, as far as they are known.
    """
    if not experiment.phases:
        if experiment.plays.has(ENGAGEMENT) and not experiment.humans:
            yield Issue((*path, "humans"), "missing")
        return
    for setting in experiment.replaced_by_phases:
        if setting in experiment.model_fields_set:
            yield Issue((*path, setting), "stands in the phases; leave it out", at="key")
    if PHASES in humans and experiment.met:
        yield Issue(("humans", PHASES), "is what is said where humans are met in turn; choose another name", at="key")
    trial_steps, plan = experiment.trial_steps, any(player.plans for player in players)
    for index, phase in enumerate(experiment.phases):
        inside = (*path, PHASES, index)
        steps = getattr(phase, "steps", None)
        if steps is not None and steps % trial_steps:
            yield Issue((*inside, "steps"), f"must be a whole number of trials of {trial_steps} steps (got {steps})")
        if phase.met and phase.met not in humans:
            message = f"no human is called {phase.met}{or_else(phase.met, list(humans))}"
            yield Issue((*inside, "human"), message)
        if phase.plan_every is not None and players and not plan:
            message = "means nothing here: no agent that acts here plans; leave it out"
            yield Issue((*inside, "plan_every"), message, at="key")
