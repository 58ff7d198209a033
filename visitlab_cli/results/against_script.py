"""What was learned against the script, which was told the rules: the difference of the two, seed by seed."""

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.results.estimates import Estimate, mean_of
from visitlab_cli.results.groups import Group
from visitlab_cli.results.seeds import seed_values

SCRIPTED = "scripted"
"""The kind of agent."""
OF_THE_AGENT = {"agents", "humans", "steps", "trials", "start_from", "models", "modules"}
"""Settings of an experiment that say who plays, how long and how it learns: the script does the same throughout."""


class AgainstScript(NamedTuple):
    """A group and the script in the same task, with the same human and rules; `difference` is the group's less it.

    Paired by seed: `n` seeds have finished both.
    """

    group: Group
    script: Group
    difference: Estimate
    n: int


def against_script(run: Path, groups: Sequence[Group]) -> list[AgainstScript]:
    """A line for each group of another agent and each script that it can be compared with, both with finished cells.

    A script of the same experiment is preferred to that of another one.

    Raises:
        RunError: a table of trials is damaged.
    """
    alike: dict[str, list[Group]] = {}
    for group in groups:
        if _scripted(group):
            alike.setdefault(_circumstances(group), []).append(group)
    lines = []
    for group in groups:
        scripts = [] if _scripted(group) else alike.get(_circumstances(group), [])
        beside = [script for script in scripts if script.experiment == group.experiment]
        for script in beside or scripts:
            ours, theirs = seed_values(run, group.cells), seed_values(run, script.cells)
            both = [ours[seed] - theirs[seed] for seed in ours if seed in theirs]
            if both:
                lines.append(AgainstScript(group, script, mean_of(both), len(both)))
    return lines


def _scripted(group: Group) -> bool:
    return group.cells[0].config.agents[group.agent].kind == SCRIPTED


def _circumstances(group: Group) -> str:
    """All that is the same for whoever acts, as text."""
    cell = group.cells[0]
    parts = cell.settings.model_dump(mode="json", exclude={*OF_THE_AGENT, *cell.settings.planning_options})
    parts["modules"] = dict(_others(group))
    humans = [cell.config.humans[human].model_dump(mode="json") for human in cell.humans]
    rules = cell.config.interaction.model_dump(mode="json")
    return json.dumps([parts, group.human, humans, rules], sort_keys=True)


def _others(group: Group) -> Iterator[tuple[str, str]]:
    """The trained modules of a visit beside the social one: their cells' paths without the seed."""
    cell = group.cells[0]
    for task, path in cell.modules.items():
        if task in cell.settings.steering:
            yield task, path.rsplit("/", 1)[0]
