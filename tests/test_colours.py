"""An agent's look follows from its name and the declared agents; colours are told apart with any eyes."""

from itertools import combinations

import numpy as np
import pytest

from visitlab_cli.colours import FIXED, PALETTE, looks_of
from visitlab_cli.paper.figures.designs import FIG_6, FIG_8

SEEN = {
    "all": np.eye(3),
    "no red": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "no green": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "no blue": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}
"""What remains of linear red, green and blue where a kind of cone is missing (Machado, Oliveira and Fernandes 2009)."""
APART = 0.07
"""The least distance in Oklab of two colours of the palette; two of Okabe and Ito's have 0.086."""
CONE = [[0.41222147, 0.53633254, 0.05144599], [0.2119035, 0.68069955, 0.10739696], [0.08830246, 0.28171884, 0.62997870]]
LAB = [
    [0.21045426, 0.79361778, -0.00407205],
    [1.97799850, -2.42859220, 0.45059371],
    [0.02590404, 0.78277177, -0.80867577],
]


def linear(colour):
    parts = np.array([int(colour[at : at + 2], 16) for at in (1, 3, 5)]) / 255
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def oklab(light):
    return LAB @ np.cbrt(CONE @ np.clip(light, 0, 1))


def contrast(one, other):
    dark, bright = sorted(linear(each) @ [0.2126, 0.7152, 0.0722] for each in (one, other))
    return (bright + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("eyes", SEEN)
@pytest.mark.parametrize("page", ["light", "dark"])
def test_colours_are_told_apart(eyes, page):
    seen = [oklab(np.array(SEEN[eyes]) @ linear(getattr(paint, page))) for paint in PALETTE]
    assert min(np.linalg.norm(one - other) for one, other in combinations(seen, 2)) > APART


@pytest.mark.parametrize(("page", "behind"), [("light", "#ffffff"), ("dark", "#1a1c20")])
def test_colours_stand_out_from_the_page(page, behind):
    assert min(contrast(getattr(paint, page), behind) for paint in PALETTE) >= 3


def test_neither_order_nor_who_else_is_there_changes_a_paper_agent():
    names = [*FIXED, *(f"mine_{number}" for number in range(10))]
    whole = looks_of(names)
    assert looks_of(reversed(names)) == whole
    for name in FIXED:
        assert looks_of([name]) == {name: whole[name]}


def test_another_agent_changes_no_more_than_one():
    names = ["mb", "mf", "dyna", "sarsa", "planner", "my_agent"]
    whole = looks_of(names)
    assert len({look.hue for look in whole.values()}) == len(names)
    for gone in names:
        rest = looks_of([name for name in names if name != gone])
        assert sum(whole[name] != look for name, look in rest.items()) <= 1


@pytest.mark.parametrize("number", [1, 8, 9, 64])
def test_many_agents_look_all_different(number):
    looks = looks_of(f"agent_{place}" for place in range(number))
    assert len(set(looks.values())) == number
    assert len({look.hue for look in looks.values()}) == min(number, 8)


def test_no_colour_means_an_agent_here_and_a_human_there():
    humans = {condition.colour.lower() for design in FIG_8 for condition in design.conditions}
    assert humans.isdisjoint(paint.light for paint in PALETTE)
    agents = {condition.group.split("/")[0]: condition for design in FIG_6 for condition in design.conditions}
    looks = looks_of([*agents, "another"])
    assert {name: (each.colour, each.marker) for name, each in agents.items()} == {
        name: (looks[name].colour, looks[name].marker) for name in agents
    }
