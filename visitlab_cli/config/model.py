"""A whole config, as it stands when `include`, `like` and overrides are resolved."""

import itertools
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Discriminator, Field, JsonValue, Tag

from visitlab_cli.agents.registry import AnyAgent
from visitlab_cli.config.experiments import AnyExperiment
from visitlab_cli.config.figure import FigureSettings
from visitlab_cli.config.labs import AnyLab
from visitlab_cli.config.names import LOG_ENDING, RESERVED_EXPERIMENTS, RESERVED_RUNS, Name
from visitlab_cli.humans.registry import AnyHuman
from visitlab_cli.settings import SOME, WORD, Settings, since
from visitlab_cli.world.geometry import DISTANCES


def _increasing(distances: tuple[int, ...]) -> tuple[int, ...]:
    if any(far <= near for near, far in itertools.pairwise(distances)):
        raise ValueError("must increase")
    return distances


def _not_reserved(name: str) -> str:
    if name.lower() in RESERVED_EXPERIMENTS:
        raise ValueError("is the name of something else in a run folder; choose another")
    return name


def _no_word(name: str) -> str:
    if name.lower() in RESERVED_RUNS:
        raise ValueError(f"{name.lower()} stands for a run, whatever its name; choose another")
    if name.lower().endswith(LOG_ENDING):
        raise ValueError(f"what ends in {LOG_ENDING} stands for a log; choose another")
    return name


def _first_to_last(trials: tuple[int, ...]) -> tuple[int, ...]:
    if trials[0] > trials[1]:
        raise ValueError("must go from the first trial to the last")
    return trials


TrialNumber = Annotated[int, Field(ge=1, le=10**9)]
Distance = Annotated[int, Field(ge=1, le=10_000)]
RunName = Annotated[Name, AfterValidator(_no_word)]
ExperimentName = Annotated[Name, AfterValidator(_not_reserved)]


class Interaction(Settings):
    """What distance between robot and human is which."""

    distances: Annotated[tuple[Distance, ...], Field(min_length=4, max_length=4), AfterValidator(_increasing)] = Field(
        default=DISTANCES,
        description="bounds d0 < d1 < d2 < d3 in cells: category 0 up to d0, 1 up to d1, 2 up to d2, "
        "3 up to d3, 4 beyond; 1, 2 and 3 are appropriate for interaction",
    )


class OneTrialIn(Settings):
    """Record some trials."""

    one_trial_in: int = Field(ge=1, le=10**9, description="n records the trials 0, n, 2 n, ...")


def _which_steps(steps: Any) -> str:
    return SOME if isinstance(steps, dict | OneTrialIn) else WORD


Steps = Annotated[
    Annotated[Literal["every", "none"], Tag(WORD)] | Annotated[OneTrialIn, Tag(SOME)],
    Discriminator(_which_steps),
]


class Record(Settings):
    """What is written to the logs; the tables of trials are whole anyway."""

    steps: Steps = Field(default="every", description="every, none, or {one_trial_in: n}")

    @property
    def one_trial_in(self) -> int:
        """Record the trials 0, n, 2 n, ...; 0 for none."""
        if isinstance(self.steps, OneTrialIn):
            return self.steps.one_trial_in
        return 1 if self.steps == "every" else 0


TrialRange = Annotated[tuple[TrialNumber, ...], Field(min_length=2, max_length=2), AfterValidator(_first_to_last)]


class Expected(Settings):
    """What a module or visit should reach; a run that misses it exits with 4."""

    value: float = Field(
        ge=-1e9,
        le=1e9,
        description="mean over seeds; of a module the reward per trial in the last 1% of trials, "
        "of a visit the goals per trial in the last tenth",
    )
    tolerance: float = Field(ge=0, le=1e9, description="how far from `value` is still right")
    trials: TrialRange | None = Field(
        default=None, description="the first and the last trial, counted from 1, that `value` is the mean of instead"
    )


class Config(Settings):
    """A config: who is there, what is trained and visited, how often, and what is recorded."""

    name: RunName = Field(description="the run's name; its folder is called <name>-<hash>")
    seed: int = Field(default=0, ge=0, lt=2**63, description="root of every random number")
    seeds: int = Field(default=1, ge=1, le=100_000, description="independent repetitions of each cell")
    humans: dict[Name, AnyHuman] = Field(default={}, description="the humans, by name")
    labs: dict[Name, AnyLab] = Field(
        default={}, description="labs other than the paper's, by name", json_schema_extra=since("0.2.0")
    )
    agents: dict[Name, AnyAgent] = Field(min_length=1, description="the learning agents, by name")
    experiments: dict[ExperimentName, AnyExperiment] = Field(min_length=1, description="trainings and visits, by name")
    interaction: Interaction = Field(default=Interaction(), description="distances of the interaction")
    record: Record = Field(default=Record(), description="what is logged")
    vary: dict[str, Annotated[tuple[JsonValue, ...], Field(min_length=1)]] = Field(
        default={}, description="a grid: dotted paths into the config, each with the values it takes in turn"
    )
    expected: dict[str, Expected] = Field(
        default={},
        description="what experiment/agent, experiment/agent/human or visit/human should reach; "
        "checked where nothing but `seed`, `seeds` and these themselves was overridden",
    )
    figure: FigureSettings | None = Field(
        default=None,
        description="the one figure that answers its question, which `visitlab figures` then draws",
        json_schema_extra=since("0.2.0"),
    )

    @property
    def kinds(self) -> set[type]:
        """The classes of the humans and agents, some of which may lie in other packages."""
        return {type(entry) for section in (self.humans, self.agents) for entry in section.values()}
