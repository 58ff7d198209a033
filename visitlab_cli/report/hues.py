"""Which colour a curve has: the same for a condition, and as far as possible for an agent, in all charts of a page."""

from collections.abc import Sequence

from visitlab_cli.results.groups import Group, Point

COLOURS = 8
"""Of the page; further hues are the same colours, dashed."""

Condition = tuple[str, str, Point]


class Hues:
    """Gives out hues, chart by chart."""

    def __init__(self) -> None:
        """Begin with none given."""
        self._agents: dict[str, int] = {}
        self._conditions: dict[Condition, int] = {}

    def of_chart(self, groups: Sequence[Group]) -> list[int]:
        """A hue for each of a chart's groups, all different: the condition's, else the agent's, else a new one.

        None is dashed where the colours suffice.
        """
        conditions = [(group.agent, group.human, group.point) for group in groups]
        few = len(groups) <= COLOURS
        found: dict[int, int] = {}
        for place, condition in enumerate(conditions):
            self._take(found, place, self._conditions.get(condition), few)
        for place, (agent, _, _) in enumerate(conditions):
            self._take(found, place, self._agents.get(agent), few)
        for place, (agent, human, point) in enumerate(conditions):
            found.setdefault(place, self._new(set(found.values())))
            self._agents.setdefault(agent, found[place])
            self._conditions.setdefault((agent, human, point), found[place])
        return [found[place] for place in range(len(groups))]

    @staticmethod
    def _take(found: dict[int, int], place: int, hue: int | None, few: bool) -> None:
        if hue is None or hue in found.values() or (few and hue >= COLOURS):
            return
        found.setdefault(place, hue)

    def _new(self, taken: set[int]) -> int:
        """A colour that the page does not have yet, else one that the chart does not have."""
        given = {*self._agents.values(), *self._conditions.values()}
        free = (hue for hue in range(COLOURS) if hue not in taken | given)
        return next(free, next(hue for hue in range(len(taken) + 1) if hue not in taken))
