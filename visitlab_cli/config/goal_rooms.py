"""The rooms that goals are drawn from: all that a lab has, or some by their numbers or letters."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Tag, WithJsonSchema

from visitlab_cli.config.labs import LabSettings, layout_called
from visitlab_cli.config.names import PAPER_LAB
from visitlab_cli.settings import SOME, WORD
from visitlab_cli.wording import shown
from visitlab_cli.world.map_faults import LETTERS, MOST_ROOMS

ALL: Literal["all"] = "all"
Rooms = tuple[int | str, ...] | Literal["all"]
"""Numbers or letters."""


def _room(given: Any) -> int | str:
    is_number = isinstance(given, int) and not isinstance(given, bool)
    if is_number or (isinstance(given, str) and given in LETTERS and len(given) == 1):
        return given  # type: ignore[no-any-return]
    raise ValueError(f"must be a room: its number, or its letter, A to Z (got {shown(given)})")


def _form(given: Any) -> str:
    return SOME if isinstance(given, list | tuple) else WORD


def _word(given: Any) -> Any:
    if given != ALL:
        raise ValueError(f"must be all or a list of rooms (got {shown(given)})")
    return given


def _several(rooms: Rooms) -> Rooms:
    if rooms == ALL:
        return rooms
    for place, room in enumerate(rooms):
        if room in rooms[:place]:
            raise ValueError(f"has {room} twice")
    if len(rooms) < 2:
        raise ValueError(f"must have at least 2 entries (got {len(rooms)})")
    return rooms


_SCHEMA = {
    "anyOf": [
        {"const": ALL},
        {
            "type": "array",
            "minItems": 2,
            "uniqueItems": True,
            "items": {
                "anyOf": [
                    {"type": "integer", "minimum": 0, "maximum": MOST_ROOMS - 1},
                    {"type": "string", "pattern": "^[A-Z]$"},
                ]
            },
        },
    ]
}
GoalRooms = Annotated[
    Annotated[tuple[Annotated[Any, BeforeValidator(_room)], ...], Tag(SOME)]
    | Annotated[Literal["all"], BeforeValidator(_word), Tag(WORD)],
    Discriminator(_form),
    AfterValidator(_several),
    WithJsonSchema(_SCHEMA),
]


def numbered(rooms: Rooms, lab: str, labs: Mapping[str, LabSettings]) -> tuple[int, ...] | Literal["all"]:
    """The numbers of rooms in a lab as they are given; `all` where that is each of them: one setting has one spelling.

    In the paper's lab that spelling is their numbers.
    """
    layout, no_goals, closed = layout_called(lab, labs)
    goals = tuple(layout.goals(no_goals, closed))
    numbers = goals
    if rooms != ALL:
        numbers = tuple(layout.letters.index(room) if isinstance(room, str) else room for room in rooms)
    return ALL if lab != PAPER_LAB and numbers == goals else numbers


def wrong_rooms(rooms: Rooms, lab: str, labs: Mapping[str, LabSettings]) -> Iterator[tuple[int | None, str]]:
    """What is wrong with goal rooms in a lab: the place of one among them, None for all, and a message."""
    layout, no_goals, closed = layout_called(lab, labs)
    goals, known = layout.goals(no_goals, closed), layout.letters
    numbers: list[int] = []
    for place, room in enumerate(() if rooms == ALL else rooms):
        if isinstance(room, str) and room not in known:
            yield place, f"no room is called {room}; there are {', '.join(known)}"
        elif isinstance(room, int) and room < 0:
            yield place, f"must be at least 0 (got {room})"
        elif isinstance(room, int) and room >= len(known):
            yield place, f"must be less than {len(known)} (got {room})"
        else:
            number = known.index(room) if isinstance(room, str) else room
            if number in numbers:
                yield None, f"has {known[number]} twice, as {number} and as its letter"
            elif number not in goals:
                shut = f"can't be reached while {' and '.join(closed)} is closed"
                yield place, f"room {known[number]} {'is a corridor' if known[number] in no_goals else shut}"
            numbers.append(number)
