"""Which colour and marker an agent has: the same in every figure and in the report, whoever else is drawn.

It follows from the agent's name and from which agents the config declares, never from their order nor from which of
them are finished or shown. The paper's agents have fixed colours. Any other name has a home colour; where two agents of
a config share a home, one of them moves to a free colour. From the ninth agent on colours come again, with another
marker.
"""

import hashlib
from collections.abc import Iterable, Sequence
from typing import NamedTuple


class Paint(NamedTuple):
    """A colour on white paper and on a dark screen, and the marker of the first agent that has it (matplotlib's)."""

    light: str
    dark: str
    marker: str


BLUE = Paint("#0072b2", "#4a80b8", "o")
VERMILION = Paint("#d55e00", "#f5501a", "s")
GREEN = Paint("#009e73", "#50dcae", "^")
GREY = Paint("#666666", "#999999", "D")
PINK = Paint("#f040e0", "#f090ff", "v")
VIOLET = Paint("#553388", "#c030f5", "P")
BROWN = Paint("#885522", "#ffdd22", "X")
TEAL = Paint("#004444", "#b8fbff", "h")
PALETTE = (BLUE, VERMILION, GREEN, GREY, PINK, VIOLET, BROWN, TEAL)
"""Told apart by colour-blind people, too, each clear of white and of a dark page: tests/test_colours.py measures it."""
FIXED = {"mb": BLUE, "rmax": VERMILION, "mf": GREEN, "mf_after_mb": GREY, "script": TEAL, "chance": BROWN}
"""The agents of the paper's configs."""


class Look(NamedTuple):
    """How an agent is drawn: the place of its colour in `PALETTE`, and its marker."""

    hue: int
    marker: str

    @property
    def colour(self) -> str:
        """On white."""
        return PALETTE[self.hue].light


def looks_of(agents: Iterable[str]) -> dict[str, Look]:
    """The look of each agent that a config declares, by name; as many colours as there are, then other markers.

    All looks differ up to 64 agents.
    """
    left = sorted(set(agents), key=lambda name: (name not in FIXED, _digest(name), name))
    found: dict[str, Look] = {}
    for turn in range(len(left)):
        taken = _one_of_each(left)
        for name, hue in taken.items():
            found[name] = Look(hue, PALETTE[(hue + turn) % len(PALETTE)].marker)
        left = [name for name in left if name not in taken]
        if not left:
            break
    return found


def _one_of_each(names: Sequence[str]) -> dict[str, int]:
    """As many of the names as there are colours, each with one of its own: first those who find their home free."""
    given: dict[str, int] = {}
    for choices in (slice(0, 1), slice(None)):
        for name in names:
            free = (hue for hue in _wishes(name)[choices] if hue not in given.values())
            hue = None if name in given else next(free, None)
            if hue is not None:
                given[name] = hue
    return given


def _wishes(name: str) -> list[int]:
    """All hues, beginning with the name's home."""
    home = PALETTE.index(FIXED[name]) if name in FIXED else _digest(name)[0] % len(PALETTE)
    others = sorted((hue for hue in range(len(PALETTE)) if hue != home), key=lambda hue: _digest(f"{name} {hue}"))
    return [home, *others]


def _digest(text: str) -> bytes:
    return hashlib.sha256(text.encode()).digest()
