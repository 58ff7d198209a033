"""Whether a curve of ours was made as the published one was: all that decides it, beside the shipped paper config.

Names don't count: a human, agent or experiment under another name is as published where its values are. Nor does how
often a visit is repeated on which models (`models`), for that decides how sure a mean is and not the mean, nor where
a curve ends.
"""

import json
from collections.abc import Sequence
from functools import cache
from typing import Any

from visitlab_cli.config.files import shipped_configs
from visitlab_cli.config.loading import load
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Module
from visitlab_cli.paper.judging.variants import Flat, deciding
from visitlab_cli.plan.cells import Cell, plan
from visitlab_cli.world.tasks import SOCIAL

PAPER = "paper"
MOST_TOLD = 3
NAME, REPEATED = ".name", "visit.models"
WHOLE = ("kind", "task")
"""Where one of these differs, what else differs beside it is another thing's."""


@cache
def paper_cells() -> dict[str, Cell]:
    """One cell of each group of the shipped paper config, by the group's path."""
    return {cell.group: cell for cell in plan(load(shipped_configs()[PAPER], ["seeds=1"]))}


def essence(cell: Cell) -> Flat:
    """All that decides the mean of a curve, by what it is and not by its name."""
    return {path: value for path, value in deciding(cell).items() if path != REPEATED and not path.endswith(NAME)}


def unlike(cell: Cell, published: Cell) -> list[str]:
    """What decides the curve of `cell` otherwise than that of a paper's cell: ['human_2.p_A 0.15, published 0.05']."""
    ours, theirs = essence(cell), essence(published)
    differing = [path for path in ours if path in theirs and ours[path] != theirs[path]]
    others = tuple(path.removesuffix(word) for path in differing for word in WHOLE if path.endswith(f".{word}"))
    told = [path for path in differing if path.rpartition(".")[2] in WHOLE or not path.startswith(others or ("\0",))]
    return [f"{_place(cell, path)} {_short(ours[path])}, published {_short(theirs[path])}" for path in told]


def in_words(differences: Sequence[str]) -> str:
    """Differences in a line, the first ones by name."""
    more = [f"{len(differences) - MOST_TOLD} more"] if len(differences) > MOST_TOLD else []
    return "; ".join([*differences[:MOST_TOLD], *more])


def _place(cell: Cell, path: str) -> str:
    """Where a config has what decides a curve, without its section."""
    head, _, rest = path.partition(".")
    if head == "visit":
        return f"{cell.experiment}.{rest}"
    if head in cell.settings.starts:
        return _place_in(cell.config, cell.settings.starts[head], rest)
    return _place_in(cell.config, Module(cell.experiment, cell.agent, cell.human), path)


def _place_in(config: Config, names: Module, path: str) -> str:
    head, _, rest = path.partition(".")
    if head == "start":
        return _place_in(config, config.experiments[names.experiment].starts[SOCIAL], rest)
    if head == "training":
        return f"{names.experiment}.{rest}"
    if head == "human":
        return f"{names.human}.{rest}"
    if head == "agent":
        agent, (role, _, setting) = config.agents[names.agent], rest.partition(".")
        return f"{getattr(agent, role)}.{setting}" if setting and role in agent.references else f"{names.agent}.{rest}"
    return f"interaction.{path}"


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, list):
        return f"[{', '.join(map(_short, value))}]"
    return value if isinstance(value, str) else json.dumps(value)
