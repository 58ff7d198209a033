"""The goal rooms of a visit, as the YAML may say them."""

from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema

from visitlab_cli.config.names import distinct
from visitlab_cli.world.lab import paper_lab

N_ROOMS = paper_lab().n_rooms


Room = Annotated[int, Field(ge=0, lt=N_ROOMS)]


def _all_rooms(rooms: Any) -> Any:
    if isinstance(rooms, list | tuple):
        return tuple(rooms)  # a tuple field takes no list from a validator
    if rooms == "all":
        return tuple(range(N_ROOMS))
    raise ValueError("must be all or a list of rooms")


GoalRooms = Annotated[
    tuple[Room, ...],
    Field(min_length=2),
    AfterValidator(distinct),
    BeforeValidator(_all_rooms),
    WithJsonSchema(
        {
            "anyOf": [
                {"const": "all"},
                {
                    "type": "array",
                    "minItems": 2,
                    "uniqueItems": True,
                    "items": {"type": "integer", "minimum": 0, "maximum": N_ROOMS - 1},
                },
            ]
        }
    ),
]
