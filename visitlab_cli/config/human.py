"""The human of a config: the six parameters of the paper's Table 1."""

import math
from typing import Annotated

from pydantic import AfterValidator, Field

from visitlab_cli.settings import Settings

SUM_TOLERANCE = 1e-9


def _sums_to_one(speeds: tuple[float, ...]) -> tuple[float, ...]:
    if abs(math.fsum(speeds) - 1) > SUM_TOLERANCE:
        raise ValueError(f"must sum to 1 (sums to {math.fsum(speeds):.10g})")
    return speeds


Probability = Annotated[float, Field(ge=0, le=1)]
SpeedDistribution = Annotated[tuple[Probability, ...], Field(min_length=3, max_length=3), AfterValidator(_sums_to_one)]


class Human(Settings):
    """How a simulated human reacts to the robot (paper, section 3.4, Table 1); only `p_S` has no default."""

    p_S: SpeedDistribution = Field(description="probabilities of moving at speed 1, 2 and 3; they sum to 1")
    p_H: Probability = Field(default=0.0, description="failing hello: probability that a hello goes unnoticed")
    p_M: Probability = Field(default=0.0, description="random movement: probability of a move when not engaged")
    p_O: Probability = Field(
        default=0.0, description="random eye movement: probability of a new heading when not engaged"
    )
    p_A: Probability = Field(default=0.0, description="losing attention: probability of disengaging at each step")
    p_P: Probability = Field(
        default=0.0, description="pointing need: probability that 'come' must be followed by pointing"
    )
