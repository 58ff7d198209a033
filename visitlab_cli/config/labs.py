"""The labs of a config: a map, or rooms in rows and columns; `closed` doors; the paper's where nothing is said."""

import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, TypeAdapter, WithJsonSchema

from visitlab_cli.config.names import PAPER_LAB
from visitlab_cli.settings import Settings
from visitlab_cli.wording import or_else, shown
from visitlab_cli.world.lab import Lab, paper_lab, room_names
from visitlab_cli.world.layout import Layout, names_of, rooms_in_rows
from visitlab_cli.world.map_faults import MOST_CELLS_A_SIDE, MOST_ROOMS, Fault, map_faults

FOLDED = "; for a map as text write | before it, which keeps its lines; > makes one of them"
_PRODUCT = r"^[1-9][0-9]? x [1-9][0-9]?$"


class MapError(ValueError):
    """A map with faults."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        """What is wrong with it, at least one."""
        super().__init__(faults[0].message)
        self.faults = faults


def as_map(text: str) -> str:
    """A map as it is kept: no empty lines before and after, no space at the ends of lines."""
    return "\n".join(line.rstrip() for line in text.splitlines()).strip("\n")


def is_map(text: str) -> bool:
    """Whether a text is a map itself, and no file's name: a line that ends, or nothing but letters and `#`."""
    return text.splitlines() != [text] or re.fullmatch("[A-Za-z#]+", text) is not None


def if_folded(text: str) -> str:
    """How a message ends about a text that may be a map whose lines have become one; else nothing."""
    return FOLDED if re.fullmatch(r"[A-Za-z#]+( [A-Za-z#]+)+\s*", text) else ""


def _sound(text: str) -> str:
    if not text.strip():
        raise ValueError(f"must be a map, or the file in which it is (got {shown(text)})")
    found = map_faults(as_map(text))
    if found:
        hint = if_folded(text) if text.splitlines() != [text] else _as_file(text)
        raise MapError(
            found if "\n" in as_map(text) or not hint else [found[0]._replace(message=found[0].message + hint)]
        )
    return as_map(text)


def _as_file(word: str) -> str:
    """What a map of a single row may have been meant as."""
    return f"; {shown(word)} is read as the map itself; is a file meant? its name has a dot or a slash"


def _product(text: Any) -> Any:
    if isinstance(text, str):
        text = re.sub(r"\s*[x×]\s*", " x ", text.strip())
    if not isinstance(text, str) or not re.fullmatch(_PRODUCT, text):
        raise ValueError(f"must be two whole numbers, as in 3 x 3 (got {shown(text)})")
    return text


def _letters(text: str) -> str:
    if not re.fullmatch("[A-Z]*", text) or len(set(text)) < len(text):
        raise ValueError(f"must be letters of rooms, A to Z, each once (got {shown(text)})")
    return "".join(sorted(text))


def _door(name: str) -> str:
    if not re.fullmatch("[A-Z]{2}", name):
        raise ValueError(f"must be a door: the letters of its two rooms, as in BE (got {shown(name)})")
    return "".join(sorted(name))


def _sorted(doors: tuple[str, ...]) -> tuple[str, ...]:
    if len(set(doors)) < len(doors):
        raise ValueError("has a door twice")
    return tuple(sorted(doors))


Product = Annotated[
    str, BeforeValidator(_product), WithJsonSchema({"type": "string", "pattern": "^ *[0-9]+ *x *[0-9]+ *$"})
]
Door = Annotated[str, AfterValidator(_door)]
"""A door's name: the letters of its two rooms, in order."""
Closed = Annotated[tuple[Door, ...], AfterValidator(_sorted)]


class LabSettings(Settings):
    """What all labs have."""

    closed: Closed = Field(default=(), description="doors that are shut, each by its two letters, as in [BE]")

    @property
    def layout(self) -> Layout:
        """The cells, rooms and doors."""
        return _layout(self)

    def make_layout(self) -> Layout:
        """The same, made anew."""
        raise NotImplementedError

    @property
    def no_goals(self) -> str:
        """The letters of rooms that are never goals."""
        return ""

    @property
    def goals(self) -> list[int]:
        """The numbers of the rooms that may be goals."""
        return self.layout.goals(self.no_goals, self.closed)

    def lab(self, toggling: Mapping[str, float] | None = None) -> Lab:
        """The lab for kernels, the same one for equal settings; some doors may be opened or shut before each trial."""
        return _lab(self, tuple((toggling or {}).items()))

    def problems(self) -> list[tuple[str, str]]:
        """What is wrong between its settings: the key and a message."""
        layout, found = self.layout, []
        for door in self.closed:
            if door not in layout.doors:
                found.append(("closed", f"no door is called {door}; there are {names_of(layout.doors)}"))
        for letter in self.no_goals:
            if letter not in layout.letters:
                found.append(("corridor", f"no room is called {letter}; there are {', '.join(layout.letters)}"))
        if not found and len(self.goals) < 2:
            key = "closed" if self.closed else "corridor"
            found.append((key, "leaves fewer than two rooms that can be goals and be reached"))
        return found


class MapLab(LabSettings):
    """A lab from a map: a letter a cell, its room's, in lower case where a doorway is; `#` is solid."""

    map: Annotated[str, AfterValidator(_sound)] = Field(
        description="a file, relative to this one, or the text itself: a line a row, a letter a cell, its room; "
        "lower case: a doorway; # is solid"
    )
    corridor: Annotated[str, AfterValidator(_letters)] = Field(
        default="", description="letters of the rooms that are never goals, as in Z"
    )

    def make_layout(self) -> Layout:
        """The map's."""
        return Layout(self.map)

    @property
    def no_goals(self) -> str:
        """The corridor."""
        return self.corridor

    def problems(self) -> list[tuple[str, str]]:
        """As always; of a single row, that it may be no map."""
        hint = "" if "\n" in self.map else _as_file(self.map)
        return [(key, message + hint) for key, message in super().problems()]


class RoomsLab(LabSettings):
    """A lab of equal rooms in rows and columns, lettered row by row from the north-west."""

    rooms: Product = Field(description="rows x columns of rooms, as in 3 x 3")
    size: Product = Field(default="8 x 8", description="rows x columns of cells that a room has")
    walls: Literal["none", "between"] = Field(default="none", description="whether there are walls between rooms")
    doorway: int = Field(
        default=2, ge=1, le=MOST_CELLS_A_SIDE, description="cells of each doorway, in the middle of each shared wall"
    )

    def make_layout(self) -> Layout:
        """As declared; of what is too large the first room, since it is refused."""
        (rows, cols), (height, width) = _numbers(self.rooms), _numbers(self.size)
        if self._too_large():
            return Layout("A")
        return rooms_in_rows(rows, cols, height, width, self.walls == "between", self.doorway)

    def problems(self) -> list[tuple[str, str]]:
        """Its size, too."""
        return self._too_large() or super().problems()

    def _too_large(self) -> list[tuple[str, str]]:
        (rows, cols), (height, width) = _numbers(self.rooms), _numbers(self.size)
        found = []
        if rows * cols > MOST_ROOMS:
            found.append(("rooms", f"at most {MOST_ROOMS} rooms (got {rows * cols})"))
        if max(rows * height, cols * width) > MOST_CELLS_A_SIDE:
            got = f"got {rows * height} x {cols * width}"
            found.append(("size", f"at most {MOST_CELLS_A_SIDE} x {MOST_CELLS_A_SIDE} cells in all ({got})"))
        if self.walls == "between" and self.doorway > min(height, width):
            found.append(("doorway", f"wider than a room's side, {min(height, width)} cells (got {self.doorway})"))
        return found


def _numbers(product: str) -> tuple[int, int]:
    first, second = product.split(" x ")
    return int(first), int(second)


FORMS = ("map", "rooms")
"""The setting that says of which form a lab is."""


def _form(given: Any) -> str | None:
    if isinstance(given, LabSettings):
        return FORMS[isinstance(given, RoomsLab)]
    if not isinstance(given, Mapping):
        return FORMS[0]  # which then says that it is no mapping
    return next((form for form in FORMS if form in given), None)


AnyLab = Annotated[Annotated[MapLab, Tag(FORMS[0])] | Annotated[RoomsLab, Tag(FORMS[1])], Discriminator(_form)]
_ANY_LAB: TypeAdapter[LabSettings] = TypeAdapter(AnyLab)


@cache
def _layout(settings: LabSettings) -> Layout:
    return settings.make_layout()


@cache
def _lab(settings: LabSettings, toggling: tuple[tuple[str, float], ...]) -> Lab:
    return settings.layout.lab(settings.no_goals, settings.closed, dict(toggling))


def lab_called(name: str, labs: Mapping[str, LabSettings], toggling: Mapping[str, float] | None = None) -> Lab:
    """A declared lab, or the paper's; `toggling` doors may be opened or shut before each trial."""
    return paper_lab() if name == PAPER_LAB else labs[name].lab(toggling)


@cache
def paper_layout() -> Layout:
    """The paper's lab as a map, all in lower case: nothing parts its rooms."""
    return rooms_in_rows(3, 3, 8, 8, walled=False, doorway=8)


def layout_called(name: str, labs: Mapping[str, LabSettings]) -> tuple[Layout, str, tuple[str, ...]]:
    """The layout of a declared lab or of the paper's, the letters that are no goals, the doors that are shut."""
    if name == PAPER_LAB:
        return paper_layout(), "", ()
    return labs[name].layout, labs[name].no_goals, labs[name].closed


def lab_from_plain(config: Mapping[str, Any], experiment: Mapping[str, Any], phase: int | None = None) -> Lab:
    """The lab of an experiment, or of a phase of it, of a config as plain values, such as a log carries.

    Raises:
        ValueError, LookupError, TypeError, AttributeError: what it says makes no lab.
    """
    said: Mapping[str, Any] = {} if phase is None else experiment["phases"][phase]
    name, doors = said.get("lab", experiment.get("lab", PAPER_LAB)), said.get("doors")
    if name == PAPER_LAB:
        return paper_lab()
    settings = _ANY_LAB.validate_python(config["labs"][name], strict=False)
    wrong = settings.problems()
    if wrong:
        raise ValueError(f"labs.{name}.{wrong[0][0]}: {wrong[0][1]}")
    return settings.lab(doors)


def unknown_lab(name: str, labs: Mapping[str, Any]) -> str:
    """That there is no lab of a name."""
    return f"no lab is called {name}{or_else(name, labs_of(labs))}"


def labs_of(labs: Mapping[str, Any]) -> list[str]:
    """The names of all labs that a config may mean: the paper's, and those declared."""
    return list(dict.fromkeys([PAPER_LAB, *labs]))


def about_lab(name: str, labs: Mapping[str, LabSettings]) -> dict[str, Any]:
    """A lab as plain values: its size in cells, rooms, those that may be goals, doors with their cells, its map."""
    layout, no_goals, closed = layout_called(name, labs)
    rooms = room_names(lab_called(name, labs))
    doors = {} if name == PAPER_LAB or not any(map(str.isupper, layout.text)) else layout.doors
    return {
        "rows": layout.rows,
        "cols": layout.cols,
        "rooms": list(rooms),
        "goals": [rooms[room] for room in layout.goals(no_goals, closed)],
        "doors": {door: {"cells": len(pairs), "shut": door in closed} for door, pairs in doors.items()},
        "map": layout.text,
    }
