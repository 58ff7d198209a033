"""Words in lines: as wide as there is room for, nothing lost."""

import pytest

from visitlab_cli.pictures.style import STYLE, styled
from visitlab_cli.pictures.words import fitting, height_of, in_lines, width_of

LONG = "teenager_who_is_slow_and_very_distractible_and_needs_pointing_64"


@pytest.fixture(autouse=True)
def _style():
    with styled(STYLE):
        yield


def test_a_line_ends_behind_a_word():
    assert in_lines("slow_and_distractible", 0.7, 7) == "slow_and_\ndistractible"
    assert in_lines("slow and distractible", 0.7, 7) == "slow and\ndistractible"
    assert in_lines("slow and distractible", 9, 7) == "slow and distractible"


@pytest.mark.parametrize("words", [LONG, LONG.replace("_", " "), "W" * 64, "one " + "i" * 64, "a"])
@pytest.mark.parametrize("weight", ["normal", "bold"])
def test_no_line_is_too_wide_and_no_letter_lost(words, weight):
    text = in_lines(words, 0.8, 7, weight)
    assert all(width_of(line, 7, weight) <= 0.8 for line in text.splitlines())
    assert text.replace("\n", "").replace(" ", "") == words.replace(" ", "")


def test_what_is_too_high_is_made_smaller():
    text, size = fitting(LONG, 0.8, 0.4, 7)
    assert size < 7
    assert height_of(text, size) <= 0.4
    assert fitting("slow", 0.8, 0.4, 7) == ("slow", 7)
