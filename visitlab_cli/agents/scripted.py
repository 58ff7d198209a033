"""A bar that needs no learning: approach, say hello, ask to come, point if asked to, then lead.

The whole script is one table over the social module's states, so that it plays as any greedy agent does.
"""

from typing import ClassVar, Literal

from visitlab_cli.agents.base import AgentParameters, Saved, Setting, zeros
from visitlab_cli.agents.greedy_table import GreedyTable
from visitlab_cli.world.columns import SOCIAL, VISIT


class ScriptedParameters(AgentParameters):
    """Approach, hello, come, point if needed, lead; for the social task and the visit."""

    tasks: ClassVar[tuple[str, ...]] = (SOCIAL, VISIT)
    kind: Literal["scripted"]

    def create(self, setting: Setting) -> GreedyTable:
        """The script as a table: 1 for the action to take in a state."""
        return GreedyTable(zeros(setting))

    def restore(self, setting: Setting, saved: Saved) -> GreedyTable:
        """The script does not change."""
        return self.create(setting)

    def save(self, record: GreedyTable) -> Saved:
        """The table."""
        return {"q": record.q}
