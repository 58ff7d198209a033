"""Marginal means of a grid: what each value of a setting reaches, averaged over all the other settings."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from statistics import fmean
from typing import NamedTuple

from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group
from visitlab_cli.results.seeds import seed_values
from visitlab_cli.results.varying import NOTHING, Varying, varying

AGENT, HUMAN = "agent", "human"


class Marginal(NamedTuple):
    """An experiment's mean at one `value` of a `setting`, of one agent or (agent "") of all.

    It is the mean of `conditions`, each of the same weight; `n` seeds have finished all of them. `value` is over these
    seeds, None where there is none. `groups` are the conditions.
    """

    experiment: str
    agent: str
    setting: str
    value: str
    measure: str
    mean: Estimate | None
    n: int
    groups: list[Group]

    @property
    def conditions(self) -> int:
        """How many are averaged."""
        return len(self.groups)


def marginals(run: Path, groups: Sequence[Group]) -> list[Marginal]:
    """The marginal means of a run's groups: of humans, varied settings and, where several are averaged, agents.

    Of a setting that nothing else varies beside there is no mean over others, and no line.

    Raises:
        RunError: a table of trials is damaged.
    """
    varied = varying((group.point for group in groups), taken=(AGENT, HUMAN))
    reached = {group.path: seed_values(run, group.cells) for group in groups}
    lines = []
    for experiment in dict.fromkeys(group.experiment for group in groups):
        members = [group for group in groups if group.experiment == experiment]
        agents = list(dict.fromkeys(group.agent for group in members))
        for agent in ["", *agents] if len(agents) > 1 else agents:
            for setting, value, those in _parts(members, agent, varied):
                tables = [reached[group.path] for group in those]
                values = [
                    fmean(table[seed] for table in tables) for seed in tables[0] if all(seed in t for t in tables)
                ]
                mean = mean_of(values) if values else None
                lines.append(Marginal(experiment, agent, setting, value, those[0].measure, mean, len(values), those))
    return lines


def _parts(members: Sequence[Group], agent: str, varied: Varying) -> Iterator[tuple[str, str, list[Group]]]:
    """Each setting with each of its values and the groups that have it, where there are several values and others."""
    mine = [group for group in members if agent in ("", group.agent)]
    told = [(group, _settings(group, varied)) for group in mine]
    for setting in [AGENT, HUMAN, *varied.heads.values()]:
        parts: dict[str, list[Group]] = {}
        for group, settings in told:
            if settings[setting] not in ("", NOTHING):
                parts.setdefault(settings[setting], []).append(group)
        having = [group for those in parts.values() for group in those]
        repeated = not agent and setting != AGENT and len({group.agent for group in having}) < 2
        if len(parts) > 1 and len(having) > len(parts) and not repeated:
            yield from ((setting, value, those) for value, those in parts.items())


def _settings(group: Group, varied: Varying) -> dict[str, str]:
    columns = dict(zip(varied.heads.values(), varied.values(group.point), strict=True))
    return {AGENT: group.agent, HUMAN: group.human, **columns}
