"""A human who is curious: while nobody has won its attention, it looks at a robot that it could see."""

from typing import Literal, NamedTuple

from pydantic import Field

from visitlab_cli import REACT, Engagement
from visitlab_cli.humans.six_parameters import Human, SixParameters
from visitlab_cli.random_numbers import happens
from visitlab_cli.world.enums import N_DIRECTIONS
from visitlab_cli.world.geometry import is_appropriate
from visitlab_cli.world.human import react as reacts
from visitlab_cli.world.scene import reaction

NONE = int(Engagement.NONE)


class Curious(NamedTuple):
    """The paper's human, and how likely it turns to a robot that is near."""

    p_speed_1: float
    p_speed_2: float
    p_H: float
    p_M: float
    p_O: float
    p_A: float
    p_P: float
    p_C: float


class CuriousParameters(SixParameters):
    """The paper's six parameters, and one more."""

    kind: Literal["curious"]
    p_C: float = Field(
        default=0.5, ge=0, le=1, description="probability of turning to a robot that is not too far or close"
    )

    def create(self):
        """The numbers that the rules take."""
        return Curious(*super().create(), float(self.p_C))


@REACT.of(Curious)
def react(human, lab, geometry, scene, action, random):
    """As the paper's human; then, where it is not engaged, perhaps a turn to the robot."""
    plain = Human(human.p_speed_1, human.p_speed_2, human.p_H, human.p_M, human.p_O, human.p_A, human.p_P)
    did = reacts(plain, lab, geometry, scene, action, random)
    heading = did.human_heading
    if did.engagement == NONE and is_appropriate(scene.distance) and happens(random, human.p_C):
        heading = (scene.angle + N_DIRECTIONS // 2) % N_DIRECTIONS
    return reaction(did.human_row, did.human_col, heading, did.engagement, did.human_action, did.human_memory)
