"""A kind of agent in a file: it knows navigation's exact values beforehand."""

from typing import ClassVar, Literal

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.declared import floats
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.exact.navigation import navigation_optimal_q


class KnowsAllParameters(AgentParameters):
    """Acts by the optimal Q."""

    tasks: ClassVar[tuple[str, ...]] = ("navigation",)
    learns: ClassVar[bool] = False
    kind: Literal["knows_all"]

    def create(self, setting):
        return GreedyTable(navigation_optimal_q(0.9).copy())

    def restore(self, setting, saved):
        return self.create(setting)

    def save(self, record):
        return {"q": record.q}

    def arrays(self, setting):
        return {"q": floats(setting.n_states, setting.n_actions)}
