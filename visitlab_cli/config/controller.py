"""The controller of a visit: what it does otherwise than the paper's Fig. 5, and how the YAML says it."""

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, WithJsonSchema

from visitlab_cli.simulation.controller import LEAD, MASK, PLAN, ROUTE

PAPER = "paper"
OPTIONS = (ROUTE, MASK, PLAN)
"""What may be chosen one by one; `lead` implies all."""
FARTHEST = 10
"""The largest appropriate distance that leading is planned for, in cells."""


def _one_spelling(given: Any) -> Any:
    """`paper`, `lead` (with all that it implies), or the options in their order."""
    names = [given] if isinstance(given, str) else given
    if not isinstance(names, list | tuple) or not all(name in (PAPER, LEAD, *OPTIONS) for name in names):
        raise ValueError("must be paper, lead, route, mask or plan, or a list of route, mask, plan and lead")
    if not names:
        raise ValueError("must not be empty; the paper's is called paper")
    if len(set(names)) < len(names):
        raise ValueError("has the same twice")
    if PAPER in names and len(names) > 1:
        raise ValueError("paper does without the others; leave it out")
    if LEAD in names:
        return LEAD
    return PAPER if PAPER in names else tuple(name for name in OPTIONS if name in names)


Controller = Annotated[
    Literal["paper", "lead"] | tuple[Literal["route", "mask", "plan"], ...],
    BeforeValidator(_one_spelling),
    WithJsonSchema(
        {
            "anyOf": [
                {"enum": [PAPER, LEAD, *OPTIONS]},
                {"type": "array", "minItems": 1, "uniqueItems": True, "items": {"enum": [*OPTIONS, LEAD]}},
            ]
        }
    ),
]


def options_of(controller: str | Sequence[str]) -> tuple[str, ...]:
    """All that a controller does otherwise than the paper; `lead` with what it implies."""
    if controller == LEAD:
        return (*OPTIONS, LEAD)
    return () if controller == PAPER else tuple(controller)
