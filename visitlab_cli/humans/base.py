"""What a human of a config is: validated parameters that make the record which the tasks meet."""

import math
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, Field

from visitlab_cli.kinds import Kind

SUM_TOLERANCE = 1e-9


def _sums_to_one(speeds: tuple[float, ...]) -> tuple[float, ...]:
    if abs(math.fsum(speeds) - 1) > SUM_TOLERANCE:
        raise ValueError(f"must sum to 1 (sums to {math.fsum(speeds):.10g})")
    return speeds


Probability = Annotated[float, Field(ge=0, le=1)]
SpeedDistribution = Annotated[tuple[Probability, ...], Field(min_length=3, max_length=3), AfterValidator(_sums_to_one)]


class HumanParameters(Kind):
    """A human as the YAML declares it; a subclass adds its numbers, and all but the paper's `kind`, a Literal."""

    remembers: ClassVar[bool] = False
    """Whether its rules use `human_memory`: then the log has it as a column."""

    def create(self) -> Any:
        """The human's record, for which its rules are registered with `REACT`."""
        raise NotImplementedError
