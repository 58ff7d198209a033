"""The colours of a scene: Okabe and Ito's, told apart by the colour-blind; robot red, human blue as in the paper."""

Colour = tuple[int, int, int]

ROBOT: Colour = (213, 94, 0)
HUMAN: Colour = (0, 114, 178)
VISUAL_FIELD: Colour = (86, 180, 233)
FACING_FIELD: Colour = (0, 158, 115)
GOAL: Colour = (240, 180, 40)
GOAL_FLOOR: Colour = (252, 226, 154)
REACHED_FLOOR: Colour = (214, 200, 230)
FLAG: Colour = (222, 140, 0)
DESIRED: Colour = (170, 60, 140)
INK: Colour = (45, 45, 50)
FLOOR: Colour = (246, 246, 244)
WALL: Colour = (120, 120, 125)
SHUT: Colour = (150, 75, 20)
OPEN: Colour = (200, 200, 198)
TILE: Colour = (222, 222, 220)

LEVEL_COLOURS: tuple[Colour, ...] = (
    (125, 125, 125),
    (165, 205, 225),
    (86, 180, 233),
    (204, 121, 167),
    (0, 114, 178),
    (240, 228, 66),
    (230, 159, 0),
    (0, 158, 115),
)
"""Of the interaction levels, in their order."""
ACTION_COLOURS: tuple[Colour, ...] = (
    (150, 150, 150),
    (80, 80, 80),
    (86, 180, 233),
    (240, 228, 66),
    (230, 159, 0),
    (204, 121, 167),
    (0, 114, 178),
)
"""Of the kinds of action, in the order of `words.ACTION_KINDS`."""


def css(colour: Colour) -> str:
    """A colour as a page writes it."""
    return "#" + bytes(colour).hex()


def shares(colour: Colour) -> tuple[float, float, float]:
    """A colour as red, green and blue from 0 to 1, as matplotlib and Foxglove have it."""
    red, green, blue = colour
    return red / 255, green / 255, blue / 255
