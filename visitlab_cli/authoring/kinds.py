"""The agent that a command names: a kind, built in or somebody else's, with parameters as `key=value`."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

import yaml

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.registry import KINDS
from visitlab_cli.config.building import check_plugin_files
from visitlab_cli.config.loading import load_text
from visitlab_cli.errors import ConfigError, NotFoundError, RunError, UsageError
from visitlab_cli.kinds import KIND
from visitlab_cli.plugins import NoSuchKindError, PluginError, find
from visitlab_cli.wording import or_else, printable
from visitlab_cli.world.columns import ENGAGEMENT
from visitlab_cli.world.tasks import SOCIAL, TASKS

AGENT = "it"


def agent_of(word: str, parameters: Sequence[str] = ()) -> AgentParameters:
    """The parameters of an agent of a kind.

    Args:
        word: the kind, as a config names it.
        parameters: `key=value` each, the value as in YAML; the others are as by default.

    Raises:
        NotFoundError: nobody declares the kind.
        RunError: it can't be used.
        UsageError: a parameter is not `key=value`, or the kind refers to other agents and is nothing alone.
        ConfigError: a parameter is not one of the kind's, or has a value that it can't have.
    """
    check_plugin_files()
    try:
        kind: type[AgentParameters] = KINDS.get(word) or find("agents", word, AgentParameters)
    except NoSuchKindError as error:
        raise NotFoundError(f"{error}{or_else(word, list(KINDS))}") from None
    except PluginError as error:
        raise RunError(str(error)) from error
    if kind.references:
        raise UsageError(
            f"{word}: refers to other agents ({', '.join(kind.references)}), and is nothing to check alone"
        )
    values, given = {}, {}
    for each in parameters:
        key, equals, text = each.partition("=")
        if not (key and equals):
            raise UsageError(f"{printable(each)}: must be key=value")
        if key == KIND:
            raise UsageError(f"{printable(each)}: the kind is said before, without {KIND}=")
        try:
            values[key], given[key] = yaml.safe_load(text), each
        except yaml.YAMLError:
            raise UsageError(f"{printable(each)}: the value is no YAML") from None
    task = SOCIAL if SOCIAL in kind.tasks else kind.tasks[0]  # with some settings it plays no other
    document = {
        "name": "check",
        "humans": {"somebody": {"p_S": [0, 0.5, 0.5]}},
        "agents": {AGENT: {KIND: word, **values}},
        "experiments": {
            "check": {"task": task, "agents": [AGENT], "steps": 1000}
            | ({"humans": ["somebody"]} if TASKS[task].has(ENGAGEMENT) else {})
        },
    }
    try:
        return load_text(json.dumps(document), "KEY=VALUE").agents[AGENT]
    except ConfigError as error:
        raise ConfigError("\n".join(_in_words(word, given, each) for each in error.problems), error.problems) from None


def _in_words(word: str, given: Mapping[str, str], problem: Mapping[str, Any]) -> str:
    """What is wrong with what was given, or with the kind as it is then."""
    section, *path = str(problem["path"]).split(".")
    key = path[1] if section == "agents" and len(path) > 1 else None
    return f"{word if key is None else printable(given.get(key, key))}: {problem['message']}"
