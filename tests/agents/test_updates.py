"""How many values an agent changes a step, by what it saved."""

import numpy as np
import pytest

from visitlab_cli.agents.base import Setting
from visitlab_cli.agents.model_based import ModelBasedParameters
from visitlab_cli.agents.q_learning import QLearningParameters
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.agents.rmax import RMaxParameters

SETTING = Setting("social", 3, 4, 1000)
SAVED = {"visits": np.array([[0, 1, 1, 0], [5, 0, 9, 0], [0, 4, 0, 0]])}


@pytest.mark.parametrize(
    ("agent", "updates"),
    [
        (QLearningParameters(kind="q_learning"), 1),
        (ModelBasedParameters(kind="model_based", plan_every=10), 12 / 10),
        (ModelBasedParameters(kind="model_based", plan_every=10, unvisited="zero"), 5 / 10),
        (RMaxParameters(kind="rmax", plan_every=10), 2 / 10),
        (RMaxParameters(kind="rmax", plan_every=10, m=1), 5 / 10),
        (KINDS["random"](kind="random"), 0),
    ],
)
def test_a_step_changes_the_swept_pairs_over_the_steps_between_sweeps(agent, updates):
    assert agent.updates_a_step(SETTING, SAVED) == updates


def test_who_does_not_say_it_is_not_guessed():
    class Silent(QLearningParameters):
        updates_a_step = QLearningParameters.__mro__[1].updates_a_step

    assert Silent(kind="q_learning").updates_a_step(SETTING, SAVED) is None
