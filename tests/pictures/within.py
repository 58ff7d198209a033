"""Whether the words of a figure can be read: all within it, none upon another."""

from itertools import combinations
from unittest.mock import patch

SLACK = 1.0
"""Pixels."""


def words_of(figure):
    """Each text that is drawn, with its box in pixels."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.text import Text

    drawn = []
    draw = Text.draw

    def draw_and_note(text, renderer):
        drawn.append(text)
        draw(text, renderer)

    with patch.object(Text, "draw", draw_and_note):
        FigureCanvasAgg(figure).draw()
    return [(text.get_text(), text.get_window_extent()) for text in drawn if text.get_text().strip()]


def beyond(figure, words):
    """Those of a figure's texts, given with their boxes, that its edge cuts off."""
    page = figure.bbox
    return [
        text
        for text, box in words
        if box.x0 < -SLACK or box.y0 < -SLACK or box.x1 > page.x1 + SLACK or box.y1 > page.y1 + SLACK
    ]


def upon_another(words):
    """Pairs of texts, given with their boxes, that overlap."""
    return [
        (first, second)
        for (first, a), (second, b) in combinations(words, 2)
        if min(a.x1, b.x1) - max(a.x0, b.x0) > SLACK and min(a.y1, b.y1) - max(a.y0, b.y0) > SLACK
    ]
