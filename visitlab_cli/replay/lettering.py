"""Words drawn as strokes, so that they keep their size in the scene: Rerun's own labels keep theirs on the screen."""

import numpy as np
import numpy.typing as npt

Strokes = list[npt.NDArray[np.float32]]

# Each glyph on a grid 2 wide and 4 high, y downwards: strokes of points as pairs of digits x, y.
_GLYPHS = {
    "A": "04 01 10 21 24,03 23",
    "B": "02 12 23 14 04 00 10 21 12",
    "C": "21 10 01 03 14 23",
    "D": "00 04 14 23 21 10 00",
    "E": "20 00 04 24,02 12",
    "F": "20 00 04,02 12",
    "G": "21 10 01 03 14 23 22 12",
    "H": "00 04,20 24,02 22",
    "I": "00 20,10 14,04 24",
    "J": "20 23 14 03",
    "K": "00 04,20 02 24",
    "L": "00 04 24",
    "M": "04 00 12 20 24",
    "N": "04 00 24 20",
    "O": "10 21 23 14 03 01 10",
    "P": "04 00 10 21 12 02",
    "Q": "10 21 23 14 03 01 10,13 24",
    "R": "04 00 10 21 12 02,12 24",
    "S": "21 10 01 23 14 03",
    "T": "00 20,10 14",
    "U": "00 03 14 23 20",
    "V": "00 14 20",
    "W": "00 04 12 24 20",
    "X": "00 24,20 04",
    "Y": "00 12 20,12 14",
    "Z": "00 20 04 24",
    "!": "10 12,14 14",
    "0": "10 21 23 14 03 01 10",
    "1": "01 10 14,04 24",
    "2": "01 10 21 04 24",
    "3": "00 20 11 22 23 14 03",
    "4": "14 10 03 23",
    "5": "20 00 02 12 23 14 03",
    "6": "20 02 03 14 23 12 02",
    "7": "00 20 14",
    "8": "10 21 03 14 23 01 10",
    "9": "04 22 21 10 01 12 22",
}
_WIDTH, _HEIGHT, _GAP, _SPACE = 2, 4, 1.2, 1.6


def width_of(text: str, height: float) -> float:
    """How wide `text` is in letters of `height`."""
    units = sum(_SPACE if letter == " " else _WIDTH + _GAP for letter in text) - _GAP
    return units * height / _HEIGHT


def strokes(text: str, middle: tuple[float, float], height: float) -> Strokes:
    """The strokes of `text` around its `middle`, each of shape (points, 2); letters without a glyph leave a gap."""
    scale = height / _HEIGHT
    left, top = middle[0] - width_of(text, height) / 2, middle[1] - height / 2
    drawn: Strokes = []
    for letter in text:
        for stroke in _GLYPHS.get(letter, "").split(",") if letter in _GLYPHS else ():
            points = np.array([[int(pair[0]), int(pair[1])] for pair in stroke.split()], np.float32)
            points[-1, 1] += 0.05 * (len(points) == 2 and bool((points[0] == points[1]).all()))  # a dot has a length
            drawn.append((points * scale + np.array([left, top])).astype(np.float32))
        left += scale * (_SPACE if letter == " " else _WIDTH + _GAP)
    return drawn
