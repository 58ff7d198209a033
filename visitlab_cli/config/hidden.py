"""What a config says of hidden engagement: what is observed, and by which parameters a belief is formed."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal, Self

from pydantic import Field, PrivateAttr

from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.errors import ConfigError
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.settings import Settings, since
from visitlab_cli.world.belief import EVENTS, N_PARAMETERS, Belief, make_belief
from visitlab_cli.world.enums import MAX_SPEED
from visitlab_cli.world.perception import Levels, Perception, Sights
from visitlab_cli.yaml.problems import Issue, Path

LEVELS, GEOMETRY = "levels", "geometry"
EM, GIVEN = "em", "given"
UNSAID: Any = None
NOT_SIX = "no belief is given the parameters of this kind of human, which are not the paper's; say parameters: em"
ARRAYS = {"belief_parameters": (N_PARAMETERS,), "belief_sums": (EVENTS,), "belief_speeds": (MAX_SPEED,)}
"""What a belief that learns its parameters keeps beside the agent's arrays: their shapes by name."""


class BeliefSettings(Settings):
    """A belief about engagement that is not observed."""

    parameters: Literal["em", "given"] = Field(
        default="em", description="the human's parameters: learned from what is seen, or known from the config"
    )


class HiddenEngagement(Settings):
    """What an experiment in which a human can be engaged says of it."""

    observe: Literal["levels", "geometry"] = Field(
        default="levels",
        description="what the robot observes: the interaction level, or only who sees and faces whom (levels 0 to 4)",
        json_schema_extra=since("0.2.0"),
    )
    belief: BeliefSettings = Field(
        default=UNSAID,
        validate_default=False,
        description="where engagement is not observed: what is believed of it takes its place; left out: nothing does",
        json_schema_extra=since("0.2.0"),
    )

    _learned: bool = PrivateAttr(default=False)

    @property
    def believes(self) -> bool:
        """Whether there is a belief in place of what is not observed."""
        return self.observe == GEOMETRY and self.belief is not None

    @property
    def learns_belief(self) -> bool:
        """Whether that belief learns its parameters."""
        return self.believes and self.belief.parameters == EM

    @property
    def perceived_as(self) -> str:
        """What tells the types of its records from those of one to whom nothing is hidden."""
        return "" if self.observe == LEVELS else "belief" if self.believes else "sights"

    @property
    def unsaid_of_engagement(self) -> tuple[str, ...]:
        """The settings that mean nothing as things stand."""
        return () if self.believes else ("belief",)

    def declared_belief(self) -> Mapping[str, Declared]:
        """What each of the arrays of a belief that learns must be."""
        return {name: floats(*shape) for name, shape in ARRAYS.items()} if self.learns_belief else {}

    def perception(self, human: Any, saved: Saved) -> Perception:
        """What the robot perceives of a human; a belief that learns goes on from what was `saved`, if there is some.

        Args:
            human: as it is declared.
            saved: arrays by their names in `ARRAYS`.
        """
        if self.observe == LEVELS:
            return Levels()
        if not self.believes:
            return Sights()
        if not self.learns_belief:
            if type(human) is not SixParameters:
                raise ConfigError(NOT_SIX)
            names = ("p_H", "p_M", "p_O", "p_A", "p_P")
            return make_belief([*human.p_S, *(getattr(human, name) for name in names)])
        belief = make_belief()
        if ARRAYS.keys() <= saved.keys():
            belief.parameters[:], belief.speeds[:] = saved["belief_parameters"], saved["belief_speeds"]
            belief.sums[:] = saved["belief_sums"]
        return belief._replace(learns=not self._learned)

    def learned(self) -> Self:
        """The same whose belief learns its parameters no more."""
        found = self.model_copy()
        found._learned = True
        return found

    def kept_of(self, perception: Any) -> Saved:
        """What is kept of a belief that learns its parameters; nothing of anything else."""
        return belief_arrays(perception) if self.learns_belief else {}


def belief_arrays(belief: Belief) -> Saved:
    """What is known of the human's parameters, as arrays: their shapes are in `ARRAYS`."""
    sums = belief.now @ belief.sums
    return {"belief_parameters": belief.parameters, "belief_sums": sums, "belief_speeds": belief.speeds}


def wrong_belief(path: Path, experiment: Any, met: Iterator[tuple[Path, str, Any]]) -> Iterator[Issue]:
    """What is wrong with how an experiment hides engagement, given whom it meets: places, names, parameters."""
    if "belief" in experiment.model_fields_set and experiment.observe == LEVELS:
        message = "means nothing here: engagement is observed; leave it out, or say observe: geometry"
        yield Issue((*path, "belief"), message, at="key")
    if experiment.believes and experiment.belief.parameters == GIVEN:
        for place, _, human in met:
            if human is not None and type(human) is not SixParameters:
                yield Issue((*path, *place), NOT_SIX)
