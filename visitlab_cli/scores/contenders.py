"""Who is scored: the agent of a kind at its defaults, or each agent that a config declares."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.config.building import build
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.files import find as find_config
from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.loading import OWN_KEYS
from visitlab_cli.config.loading import SECTIONS as NAMED
from visitlab_cli.errors import NotFoundError, RunError, UsageError
from visitlab_cli.kinds import KIND
from visitlab_cli.plugins import NoSuchKindError, PluginError, find
from visitlab_cli.scores.rows import Rows
from visitlab_cli.wording import or_else, printable
from visitlab_cli.world.task import TRAINING_TRIAL_STEPS
from visitlab_cli.world.tasks import NAVIGATION
from visitlab_cli.yaml.document import Node, Place, located
from visitlab_cli.yaml.include import read_with_includes
from visitlab_cli.yaml.overrides import apply_overrides
from visitlab_cli.yaml.problems import Problem, failure

AGENTS = "agents"
FLOOR = "random"
"""The kind of agent that stands at 0, and its name."""


class Contender(NamedTuple):
    """An agent that is scored: its parameters, and the plain settings of all agents that its config must declare."""

    name: str
    parameters: AgentParameters
    declared: Mapping[str, Any]
    tasks: tuple[str, ...]


def floor() -> Contender:
    """Random actions."""
    (contender,) = contenders(FLOOR)
    return contender


def contenders(word: str, overrides: Sequence[str] = (), names: Sequence[str] = ()) -> list[Contender]:
    """The agents that a word names.

    Args:
        word: a kind of agent, built in or somebody else's; else a YAML file, or the name of a shipped config.
        overrides: `key=value`: of a kind its parameters, of a config any of its settings.
        names: those of a config that are scored; all if there are none.

    Raises:
        NotFoundError: it is no kind, no file and no shipped config; or the config has no such agent.
        RunError: the kind can't be used.
        UsageError: an override is not `key=value`; the kind refers to other agents, and is nothing alone.
        ConfigError: a line for each problem of an agent.
    """
    kind = _kind(word)
    if kind is None:
        document, problems = _config(word)
        document, more = apply_overrides(document, overrides, NAMED)
        problems = [*problems, *more]
    else:
        if kind.references:
            others = ", ".join(kind.references)
            raise UsageError(f"{word}: refers to other agents ({others}); declare them all in a config and score that")
        document = located({AGENTS: {word: {KIND: word}}}, Place(word))
        keys = [f"{AGENTS}.{word}.{each}" if "=" in each else each for each in overrides]
        document, problems = apply_overrides(document, keys, NAMED)
    declared = _checked(document, problems)
    known = list(declared)
    for name in names:
        if name not in known:
            raise NotFoundError(f"--agent {printable(name)}: the config declares no such agent{or_else(name, known)}")
    return [_contender(name, declared) for name in names or known]


def check_names(found: Sequence[Contender], rows: Rows) -> None:
    """Refuse an agent that is called as one of the rows' own.

    Raises:
        UsageError: one is.
    """
    for contender in found:
        for name in contender.declared:
            if name in rows.agents:
                raise UsageError(f"agents.{name}: the scorecard has an agent of this name; choose another")


def _kind(word: str) -> type[AgentParameters] | None:
    if word in KINDS:
        return KINDS[word]
    try:
        return find(AGENTS, word, AgentParameters)
    except NoSuchKindError:
        return None
    except PluginError as error:
        raise RunError(str(error)) from error


def _config(word: str) -> tuple[Node, list[Problem]]:
    try:
        file: Path = find_config(word)
    except NotFoundError as error:
        if Path(word).suffix or "/" in word:
            raise
        near = or_else(word, list(KINDS))
        raise NotFoundError(f"{printable(word)}: no kind of agent, and no config of this name{near}") from error
    return read_with_includes(file, OWN_KEYS, shipped_folder())


def _checked(document: Node, problems: list[Problem]) -> dict[str, tuple[AgentParameters, Any]]:
    """The parameters and plain settings of each agent in a document, `like` resolved; nothing else of it counts."""
    here = Place(document.place.source)
    agents = document.entries().get(AGENTS, Node({}, here, here))
    if not isinstance(agents.value, dict):
        raise failure([*problems, Problem(agents.place, (AGENTS,), "must be a mapping of names to agents")])
    stub = "nobody"  # plays the experiment that a config must have
    while stub in agents.value:
        stub += "_"
    agents = agents.with_entries({**agents.entries(), stub: located({KIND: FLOOR}, here)})
    around = {
        "name": stub,
        "experiments": {stub: {"task": NAVIGATION, "agents": [stub], "steps": TRAINING_TRIAL_STEPS}},
    }
    kept = [problem for problem in problems if problem.path[:1] in ((), (AGENTS,))]
    config = build(document.with_entries({**located(around, here).entries(), AGENTS: agents}), kept)
    plain = canonical(config)[AGENTS]
    del plain[stub]
    if not plain:
        raise UsageError(f"{document.place.source}: declares no agents, so there is nothing to score")
    return {name: (config.agents[name], plain[name]) for name in plain}


def _contender(name: str, declared: Mapping[str, tuple[AgentParameters, Any]]) -> Contender:
    parameters, plain = declared[name]
    others = [getattr(parameters, field) for field in parameters.references]
    needed = {name: plain, **{other: declared[other][1] for other in others}}
    tasks = tuple(task for task in parameters.playable if all(task in declared[other][0].playable for other in others))
    return Contender(name, parameters, json.loads(json.dumps(needed)), tasks)
