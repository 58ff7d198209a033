"""What a config says of hidden engagement: what is observed, and by which parameters a belief is formed."""

from collections.abc import Iterator, Mapping
from typing import Any, Literal

from pydantic import Field

from visitlab_cli.agents.base import Saved
from visitlab_cli.agents.declared import Declared, floats
from visitlab_cli.humans.six_parameters import SixParameters
from visitlab_cli.settings import Settings, since
from visitlab_cli.world.belief import EVENTS, N_PARAMETERS, Belief, make_belief
from visitlab_cli.world.enums import MAX_SPEED
from visitlab_cli.world.perception import Levels, Perception, Sights
from visitlab_cli.yaml.problems import Issue, Path

LEVELS, GEOMETRY = "levels", "geometry"
EM, GIVEN = "em", "given"
UNSAID: Any = None
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
            names = ("p_H", "p_M", "p_O", "p_A", "p_P")
            return make_belief([*human.p_S, *(getattr(human, name) for name in names)])
        belief = make_belief()
        if ARRAYS.keys() <= saved.keys():
            belief.parameters[:], belief.speeds[:] = saved["belief_parameters"], saved["belief_speeds"]
            belief.sums[:] = saved["belief_sums"]
        return belief


def belief_arrays(perception: Any) -> Saved:
    """What is kept of a belief that learns its parameters; nothing of anything else."""
    if not isinstance(perception, Belief) or not perception.learns:
        return {}
    sums = perception.now @ perception.sums
    return {"belief_parameters": perception.parameters, "belief_sums": sums, "belief_speeds": perception.speeds}


def wrong_belief(path: Path, experiment: Any, met: Iterator[tuple[Path, str, Any]]) -> Iterator[Issue]:
    """What is wrong with how an experiment hides engagement, given whom it meets: places, names, parameters."""
    if "belief" in experiment.model_fields_set and experiment.observe == LEVELS:
        message = "means nothing here: engagement is observed; leave it out, or say observe: geometry"
        yield Issue((*path, "belief"), message, at="key")
    if experiment.believes and experiment.belief.parameters == GIVEN:
        for place, _, human in met:
            if human is not None and not isinstance(human, SixParameters):
                message = "the belief is given the paper's six parameters, which this kind of human does not have"
                yield Issue((*path, *place), message)
