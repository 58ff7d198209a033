"""From a document to a config: validation, references, and every problem positioned."""

import json
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

from pydantic import TypeAdapter, ValidationError

from visitlab_cli.agents.registry import AnyAgent
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.experiments import AnyExperiment
from visitlab_cli.config.like import resolve_like
from visitlab_cli.config.messages import issues_of
from visitlab_cli.config.model import Config
from visitlab_cli.config.references import Declared
from visitlab_cli.config.references import issues as reference_issues
from visitlab_cli.humans.registry import AnyHuman
from visitlab_cli.wording import start_comparing
from visitlab_cli.yaml.document import Node, Plain
from visitlab_cli.yaml.problems import Issue, Problem, failure, positioned

NOT_KEPT = "can't be kept: it is read otherwise than it is written (a fault of its kind)"
_ENTRIES: dict[str, TypeAdapter[Any]] = {
    "humans": TypeAdapter(AnyHuman),
    "agents": TypeAdapter(AnyAgent),
    "experiments": TypeAdapter(AnyExperiment),
}


def check(plain: Plain) -> tuple[Config | None, list[Issue]]:
    """The config that plain values make, or None and all issues within and between its parts."""
    text = json.dumps(plain)  # strict about types as JSON is, where a list may become a tuple
    try:
        config = Config.model_validate_json(text, strict=True)
    except ValidationError as error:
        return None, issues_of(error) + reference_issues(_declared(plain))
    found = reference_issues(Declared(config.humans, config.agents, config.experiments, config.expected))
    return (None, found) if found else (_with_whole_modules(config), [])


def build(document: Node, problems: list[Problem]) -> Config:
    """The config of a document (with includes and overrides), its grid not yet checked.

    Raises:
        ConfigError: with a line for each problem, those already known included.
    """
    start_comparing()
    whole, issues, broken = resolve_like(document)
    config, found = check(whole.plain())
    everything = [*problems, *(positioned(document, issue) for issue in issues)]
    everything += [positioned(whole, issue) for issue in found if issue.path[:2] not in broken]
    if not everything and config is not None:
        everything = [positioned(whole, issue) for issue in _otherwise_read_back(config)]
    if everything or config is None:
        raise failure(everything)
    return config


def _otherwise_read_back(config: Config) -> Iterator[Issue]:
    """What a run's folder would not keep as it is: a kind of agent may read its settings otherwise than it tells them.

    Such a run could be made, and would then be called edited.
    """
    plain = canonical(config)
    again, issues = check(plain)
    if again is None:
        yield from (replace(issue, message=f"{NOT_KEPT}: {issue.message}") for issue in issues)
    else:
        told = canonical(again)
        wrong = [
            (section, name)
            for section in _ENTRIES
            for name, entry in plain[section].items()
            if told[section][name] != entry or getattr(again, section)[name] != getattr(config, section)[name]
        ]
        yield from (Issue(path, NOT_KEPT, at="key") for path in wrong)


def _declared(plain: Plain) -> Declared:
    """What can be checked between the parts of a config that is partly wrong."""
    humans, agents, experiments = (_valid_entries(section, plain.get(section)) for section in _ENTRIES)
    expected = plain.get("expected")
    return Declared(humans, agents, experiments, expected if isinstance(expected, dict) else ())


def _valid_entries(section: str, entries: Plain) -> dict[str, Any]:
    valid: dict[str, Any] = {}
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        try:
            valid[name] = _ENTRIES[section].validate_json(json.dumps(entry), strict=True)
        except ValidationError:
            valid[name] = None
    return valid


def _with_whole_modules(config: Config) -> Config:
    """The config with the human of each social module named, so that one setting has one spelling."""
    experiments = {name: each.with_whole_modules(config.experiments) for name, each in config.experiments.items()}
    return config.model_copy(update={"experiments": experiments})
