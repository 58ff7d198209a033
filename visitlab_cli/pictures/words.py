"""Words in lines as wide as there is room for, measured as they are drawn and broken where a reader would."""

import re
from functools import lru_cache

POINTS_AN_INCH = 72
LINE = 1.22
"""From line to line, in font sizes."""
SMALLEST, SMALLER = 3.4, 0.4
"""Points: below this nothing is made smaller, and by how much at a time."""
MEASURED = 100
"""The font size at which outlines are measured."""
PIECES = re.compile(r"(?<=[ _/])")
"""A line may end behind these."""


def width_of(words: str, size: float, weight: str = "normal") -> float:
    """How wide a line is drawn, in inches, at this font size and weight, in the pictures' own style."""
    return size * _width_a_point(words, weight) / POINTS_AN_INCH if words.strip() else 0.0


@lru_cache(maxsize=10_000)
def _width_a_point(words: str, weight: str) -> float:
    """How wide a line is at a font size of 1: outlines grow with it."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    drawn = TextPath((0, 0), words, size=MEASURED, prop=FontProperties(weight=weight))
    return float(drawn.get_extents().width) / MEASURED


def height_of(words: str, size: float) -> float:
    """How high lines are, in inches, at this font size."""
    return (1 + words.count("\n")) * size * LINE / POINTS_AN_INCH


def in_lines(words: str, width: float, size: float, weight: str = "normal") -> str:
    """The words in as many lines as keep within a width in inches; a longer word goes on in the next line."""
    lines = [""]
    for piece in PIECES.split(words):
        if lines[-1] and width_of(lines[-1] + piece, size, weight) > width:
            lines.append("")
        for letter in piece if width_of(piece, size, weight) > width else [piece]:
            if lines[-1] and width_of(lines[-1] + letter, size, weight) > width:
                lines.append("")
            lines[-1] += letter
    return "\n".join(line.rstrip(" ") for line in lines)


def fitting(words: str, width: float, height: float, size: float) -> tuple[str, float]:
    """The words in lines, and the largest font size up to `size` at which they keep within a box in inches."""
    text = in_lines(words, width, size)
    while height_of(text, size) > height and size > SMALLEST:
        size -= SMALLER
        text = in_lines(words, width, size)
    return text, size
