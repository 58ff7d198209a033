"""A plug-in: an agent and a human whose kernels answer, at one step, what is no answer."""

from typing import Literal, NamedTuple

import numpy as np

from visitlab_cli import CHOOSE, LEARN, REACT, AgentParameters, HumanParameters
from visitlab_cli.world.scene import reaction


class Wrong(NamedTuple):
    q: np.ndarray
    answer: int
    value: float


class WrongAgent(AgentParameters):
    kind: Literal["wrong_agent"]
    answer: int = 0
    value: Literal["one", "nan", "inf", "1e31"] = "one"

    def create(self, setting):
        q = np.zeros((setting.n_states, setting.n_actions))
        return Wrong(q, self.answer, float(self.value.replace("one", "1")))

    def restore(self, setting, saved):
        return self.create(setting)._replace(q=saved["q"].copy())

    def save(self, record):
        return {"q": record.q}


@CHOOSE.of(Wrong)
def choose(agent, state, step, random):
    return agent.answer if step == 35 else 0, False


@LEARN.of(Wrong)
def learn(agent, state, action, reward, next_state, end, step, random):
    agent.q[state, action] = agent.value


class Odd(NamedTuple):
    row: int
    heading: int
    engagement: int
    human_action: int


class OddHuman(HumanParameters):
    kind: Literal["odd_human"]
    row: int = 7
    heading: int = 0
    engagement: int = 0
    human_action: int = 24

    def create(self):
        return Odd(self.row, self.heading, self.engagement, self.human_action)


@REACT.of(Odd)
def react(human, lab, geometry, scene, action, random):
    return reaction(human.row, 7, human.heading, human.engagement, human.human_action)
