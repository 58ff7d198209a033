"""From rows and an agent to a config: what it must play, and which rows it can't."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from visitlab_cli.config.loading import load_text
from visitlab_cli.config.model import Config
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.scores.contenders import Contender
from visitlab_cli.scores.rows import AGENT, Rows
from visitlab_cli.world.tasks import VISIT

ONE_TRIAL_IN = 100
"""How much is recorded: enough to look at, and some hundred megabytes for ten seeds."""
LONGEST_NAME = 64


class Asked(NamedTuple):
    """The config of an agent's run, None where it can play nothing, its cells; why it can't play an experiment."""

    contender: Contender
    unplayable: Mapping[str, str]
    config: Config | None = None
    cells: Sequence[Cell] = ()

    def cells_of(self, rows: Rows, row: str) -> list[list[Cell]]:
        """The cells that answer a row, for each group of it; none where it can't be played."""
        groups = [_named(group, self.contender.name) for group in rows.rows[row].of]
        if self.why_not(rows, row):
            return []
        return [[cell for cell in self.cells if cell.group == group] for group in groups]

    def why_not(self, rows: Rows, row: str) -> str | None:
        """Why the agent can't play a row; None where it can."""
        experiments = [group.split("/")[0] for group in rows.rows[row].of]
        return next((self.unplayable[each] for each in experiments if each in self.unplayable), None)

    def needed(self, rows: Rows, names: Sequence[str]) -> list[Cell]:
        """The cells of some rows with all that these start from, in an order in which they can be run."""
        paths = {cell.path for row in names for group in self.cells_of(rows, row) for cell in group}
        for cell in reversed(self.cells):
            if cell.path in paths:
                paths |= set(cell.modules.values())
        return [cell for cell in self.cells if cell.path in paths]


def ask(rows: Rows, contender: Contender, seeds: int) -> Asked:
    """What a contender is to play so that all rows are answered.

    Raises:
        ConfigError: the rows make no config.
    """
    unplayable = {name: why for name in rows.experiments if (why := _why_not(rows, contender, name))}
    wanted = {group.split("/")[0] for row in rows.rows.values() for group in row.of} - set(unplayable)
    while more := {start for name in wanted for start in _starts(rows.experiments[name])} - wanted:
        wanted |= more
    experiments = {name: each for name, each in rows.experiments.items() if name in wanted}
    if not experiments:
        return Asked(contender, unplayable)
    document = {
        "name": f"score-{contender.name}"[:LONGEST_NAME],
        "seeds": seeds,
        "humans": dict(rows.humans),
        "agents": {**rows.agents, **contender.declared},
        "experiments": _named(experiments, contender.name),
        "record": {"steps": {"one_trial_in": ONE_TRIAL_IN}},
    }
    config = load_text(json.dumps(document), "the rows of the scorecard")
    return Asked(contender, unplayable, config, plan(config))


def _why_not(rows: Rows, contender: Contender, name: str) -> str | None:
    """Why an experiment can't be played, itself or what it starts from."""
    experiment = rows.experiments[name]
    task = experiment.get("task")
    takes_part = AGENT in experiment.get("agents", ()) or task == VISIT
    if takes_part and task not in contender.tasks:
        return f"can't play {task}; it plays {', '.join(contender.tasks)}"
    starts = (start for start in _starts(experiment) if start in rows.experiments)
    return next((why for start in starts if (why := _why_not(rows, contender, start))), None)


def _starts(experiment: Mapping[str, Any]) -> Iterator[str]:
    """The experiments whose modules one starts from."""
    named = [experiment.get("start_from"), *experiment.get("modules", {}).values()]
    yield from (each.split("/")[0] for each in named if isinstance(each, str))


def _named(plain: Any, name: str) -> Any:
    """Plain values of the rows with the agent's name where it belongs."""
    if isinstance(plain, dict):
        return {key: _named(value, name) for key, value in plain.items()}
    if isinstance(plain, list):
        return [_named(value, name) for value in plain]
    return "/".join(name if part == AGENT else part for part in plain.split("/")) if isinstance(plain, str) else plain
