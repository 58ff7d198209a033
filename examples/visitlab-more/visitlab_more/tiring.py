"""A human who tires of greetings: each that is heard makes it more likely that the next goes unnoticed."""

from typing import ClassVar, Literal, NamedTuple

from pydantic import Field

from visitlab_cli import REACT, Action
from visitlab_cli.humans.six_parameters import Human, SixParameters
from visitlab_cli.world.human import react as reacts
from visitlab_cli.world.scene import reaction

HELLO = int(Action.HELLO)


class Tiring(NamedTuple):
    """The paper's human, and by how much a greeting raises its `p_H`."""

    p_speed_1: float
    p_speed_2: float
    p_H: float
    p_M: float
    p_O: float
    p_A: float
    p_P: float
    tires: float


class TiringParameters(SixParameters):
    """The paper's six parameters, and one more; how many greetings it heard is its memory, of a trial."""

    remembers: ClassVar[bool] = True

    kind: Literal["tiring"]
    tires: float = Field(default=0.1, ge=0, le=1, description="what each greeting of a trial adds to p_H")

    def create(self):
        """The numbers that the rules take."""
        return Tiring(*super().create(), float(self.tires))


@REACT.of(Tiring)
def react(human, lab, geometry, scene, action, random):
    """As the paper's human with this moment's `p_H`."""
    heard = scene.human_memory
    p_H = min(1.0, human.p_H + human.tires * heard)
    now = Human(human.p_speed_1, human.p_speed_2, p_H, human.p_M, human.p_O, human.p_A, human.p_P)
    did = reacts(now, lab, geometry, scene, action, random)
    if action == HELLO:
        heard += 1
    return reaction(did.human_row, did.human_col, did.human_heading, did.engagement, did.human_action, heard)
