"""What lines of tables and curves are of, so that the page can be asked for some: by task, module, agent, setting."""

from collections.abc import Sequence
from typing import Any

from visitlab_cli.config.names import Module
from visitlab_cli.results.groups import Group
from visitlab_cli.results.summary import Summary
from visitlab_cli.results.varying import NOTHING, Varying, varying

TASK, EXPERIMENT, MODULE, AGENT, HUMAN = "Task", "Experiment", "Module", "Agent", "Human"
FIXED = (TASK, EXPERIMENT, MODULE, AGENT, HUMAN)
Of = dict[str, Sequence[str]]
"""What a line is of: its values by head; a visit is of three modules, what is compared of two agents."""


class Choices:
    """Takes in lines and numbers them; the first ones are the lines of the run in their order."""

    def __init__(self, lines: Sequence[Summary]) -> None:
        """Begin with the lines of the table of results."""
        self.varied: Varying = varying((line.group.point for line in lines), taken=FIXED)
        self.heads = (*FIXED, *self.varied.heads.values())
        self._values: dict[str, dict[str, int]] = {head: {} for head in self.heads}
        self._lines: list[list[list[int]]] = []
        for line in lines:
            self.add(self.of(line.group))

    def of(self, group: Group) -> Of:
        """What a group is of."""
        settings = group.cells[0].settings
        itself = Module(group.experiment, group.agent, group.human)
        modules = [each.text for each in (settings.starts.values() if settings.assembled else (itself,))]
        found: Of = {TASK: [group.cells[0].task], EXPERIMENT: [group.experiment], MODULE: modules}
        found |= {AGENT: [group.agent], HUMAN: [group.human] if group.human else []}
        return found | {head: [value] for head, value in self.settings(group).items() if value != NOTHING}

    def settings(self, group: Group) -> dict[str, str]:
        """The value of a group in each column of what varies, by its head."""
        return dict(zip(self.varied.heads.values(), self.varied.values(group.point), strict=True))

    def add(self, of: Of) -> int:
        """Take in a line and give its number; of what it does not tell it is nothing."""
        numbers = [self._numbers(head, of.get(head, ())) for head in self.heads]
        self._lines.append(numbers)
        return len(self._lines) - 1

    def _numbers(self, head: str, values: Sequence[str]) -> list[int]:
        known = self._values[head]
        return [known.setdefault(value, len(known)) for value in values]

    def as_json(self) -> dict[str, Any]:
        """Heads, the values of each, and for each line and head the places of its values."""
        return {"heads": self.heads, "values": [list(known) for known in self._values.values()], "lines": self._lines}
