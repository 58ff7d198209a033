"""A human of somebody else's, compiled: what it says nothing of is as it would be by default."""

from typing import NamedTuple

import numpy as np

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.random_numbers import random_state
from visitlab_cli.simulation.loop import START, play
from visitlab_cli.world.columns import empty_columns
from visitlab_cli.world.enums import Action, Engagement
from visitlab_cli.world.human import REACT
from visitlab_cli.world.lab import paper_lab
from visitlab_cli.world.scene import Reaction, reaction
from visitlab_cli.world.social import make_social
from visitlab_cli.world.tasks import SOCIAL, TASKS


class Statue(NamedTuple):
    heading: int


@REACT.of(Statue)
def react(human, lab, geometry, scene, action, random):
    return reaction(scene.human_row, scene.human_col, human.heading, Engagement.NONE.value, Action.STAY.value)


def test_a_human_without_a_memory_is_compiled_and_played():
    random, columns = random_state(0, "statue"), empty_columns(100)
    agent = KINDS["random"](kind="random").create(Setting(SOCIAL, *TASKS[SOCIAL].size(paper_lab()), 40))
    cursor, rows = play(make_social(Statue(3)), agent, START, 40, random, columns, np.zeros(2))
    assert rows == 42
    assert cursor.scene.human_memory == 0
    assert (columns.human_action[:rows] >= Action.STAY).all()
    assert set(columns.human_heading[1:21]) == {3}


def test_what_has_a_default_may_be_left_out_and_is_named_once():
    assert reaction(1, 2, 3, 0, 24) == Reaction(1, 2, 3, 0, 24)
    assert reaction(1, 2, 3, 0, 24, human_memory=9).human_memory == 9
