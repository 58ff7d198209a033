"""From a document to a config: validation, references, and every problem positioned."""

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple, get_args

from pydantic import Field, TypeAdapter, ValidationError, create_model

from visitlab_cli.agents.base import AgentParameters
from visitlab_cli.agents.registry import KINDS as AGENTS
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.like import resolve_like
from visitlab_cli.config.map_files import unread_maps, with_maps
from visitlab_cli.config.messages import issues_of
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import Name
from visitlab_cli.config.references import Declared
from visitlab_cli.config.references import issues as reference_issues
from visitlab_cli.errors import ConfigError
from visitlab_cli.humans.base import HumanParameters
from visitlab_cli.humans.registry import KINDS as HUMANS
from visitlab_cli.kinds import KIND, Kind, absent, any_of
from visitlab_cli.plugins import NoSuchKindError, PluginError, faults_of_files, find
from visitlab_cli.terminal import plain
from visitlab_cli.wording import or_else, start_comparing
from visitlab_cli.yaml.document import Node, Plain
from visitlab_cli.yaml.problems import Issue, Problem, by_an_override, failure, positioned

SECTIONS = ("humans", "agents", "experiments", "labs")
NOT_KEPT = "can't be kept: it is read otherwise than it is written (a fault of its kind)"
KINDS: dict[str, tuple[dict[str, Any], type[Kind]]] = {
    "humans": (HUMANS, HumanParameters),
    "agents": (AGENTS, AgentParameters),
}
"""The built-in kinds of each section that has kinds, by their words, and what all of them derive from."""
Others = tuple[tuple[str, str, type[Kind]], ...]
"""Kinds of others: the section, the word, the class."""


class ConfigWithOthers(Config):
    """A config that names kinds of others: another process makes it anew, with what it imports itself."""

    def __reduce__(self) -> Any:
        """As its plain values."""
        return _again, (json.dumps(canonical(self)),)


def check(plain: Plain, *, kept: bool = False) -> tuple[Config | None, list[Issue]]:
    """The config that plain values make, or None and all issues within and between its parts.

    Args:
        plain: the values.
        kept: whether they are a run's own, which can be read where a kind of others is not to be had.
    """
    plain = _without_the_never(plain)
    others, issues = _others(plain, kept=kept)
    text = json.dumps(plain)  # strict about types as JSON is, where a list may become a tuple
    model = _model(others)
    try:
        config = model.model_validate_json(text, strict=True)
    except ValidationError as error:
        return None, issues + issues_of(error, model) + reference_issues(_declared(plain, model))
    farthest = config.interaction.distances[-1]
    expected = () if config.vary else config.expected  # whose names then have the point: see `wrong_expected`
    whole = Declared(config.humans, config.agents, config.experiments, expected, farthest, config.labs)
    found = issues + reference_issues(whole)
    return (None, found) if found else (_with_whole_modules(config), [])


def _without_the_never(plain: Plain) -> Plain:
    """The values without what kinds can't have where it is said to be false, as runs of before said it, too."""
    agents = plain.get("agents") if isinstance(plain, dict) else None
    if not isinstance(agents, dict):
        return plain
    never = {
        name: AGENTS[str(entry[KIND])].never
        for name, entry in agents.items()
        if isinstance(entry, dict) and isinstance(entry.get(KIND), str) and entry[KIND] in AGENTS
    }
    had = {
        name: {key: value for key, value in entry.items() if key not in never[name] or value is not False}
        for name, entry in agents.items()
        if never.get(name)
    }
    return {**plain, "agents": agents | had}


def _others(plain: Plain, *, kept: bool) -> tuple[Others, list[Issue]]:
    """The kinds of others that plain values name, and what is wrong with them."""
    found: dict[tuple[str, str], type[Kind]] = {}
    errors: dict[tuple[str, str], PluginError] = {}
    issues = []
    for section, (built_in, base) in KINDS.items():
        entries = plain.get(section) if isinstance(plain, dict) else None
        for name, entry in entries.items() if isinstance(entries, dict) else ():
            word = entry.get(KIND) if isinstance(entry, dict) else None
            if not isinstance(word, str) or word in built_in:
                continue
            key = section, word
            if key not in found and key not in errors:
                try:
                    found[key] = find(section, word, base)
                except PluginError as error:
                    errors[key] = error
                    if kept or not isinstance(error, NoSuchKindError):
                        found[key] = absent(base, word, str(error))
            if not kept and key in errors and not isinstance(errors[key], NoSuchKindError):
                issues.append(Issue((section, name, KIND), str(errors[key])))
    return tuple(
        (section, word, kind) for (section, word), kind in sorted(found.items(), key=lambda each: each[0])
    ), issues


def _model(others: Others) -> type[Config]:
    """The type of a config that may name these kinds of others, too."""
    return _wider(others) if others else Config


@cache
def _wider(others: Others) -> type[Config]:
    fields: dict[str, Any] = {}
    for section, (built_in, _) in KINDS.items():
        field = Config.model_fields[section]
        kinds = built_in | {word: kind for among, word, kind in others if among == section}
        limits: dict[str, Any] = {"min_length": 1} if field.is_required() else {"default": {}}
        fields[section] = (dict[Name, any_of(kinds)], Field(description=field.description, **limits))  # type: ignore[misc]
    return create_model("Config", __base__=ConfigWithOthers, **fields)


def agents_of(plain: Plain) -> dict[str, AgentParameters]:
    """The agents that the plain config of a log declares, the wrong ones left out."""
    others, _ = _others(plain, kept=True)
    return {name: agent for name, agent in _valid_entries(_model(others), "agents", plain["agents"]).items() if agent}


def _again(text: str) -> Config:
    config, _ = check(json.loads(text), kept=True)
    assert config is not None
    return config


def check_plugin_files() -> None:
    """Check the files that are named as plug-ins: each has kinds, of words of their own.

    Raises:
        ConfigError: with a line for each that has not.
    """
    if faults := faults_of_files(KINDS):
        raise ConfigError("\n".join(map(plain, faults.values())))


class Overridden(NamedTuple):
    """A document as it was `written`, and the sources of the places in it that overrides have made since."""

    written: Node
    overrides: Sequence[str]

    def blamed(self, document: Node, issues: Iterable[Issue]) -> Iterator[Problem]:
        """Issues of the overridden document, each with its place, those that the written one lacks with an override."""
        issues = list(issues)
        new = {*issues} - self._issues() if issues and self.overrides else set()
        for issue in issues:
            if issue in new:
                yield by_an_override(document, issue, self.overrides)
            else:
                yield positioned(document, issue)

    def _issues(self) -> set[Issue]:
        whole, issues, _ = resolve_like(with_maps(self.written, []))
        return {*issues, *check(whole.plain())[1]}


def build(
    document: Node, problems: list[Problem], overridden: Overridden | None = None, *, kept: bool = False
) -> Config:
    """The config of a document (with includes and overrides), its grid not yet checked; `kept` as `check` says.

    Raises:
        ConfigError: with a line for each problem, those already known included.
    """
    start_comparing()
    if not kept:
        check_plugin_files()
        document = with_maps(document, problems)
    overridden = overridden or Overridden(document, ())
    whole, issues, broken = resolve_like(document)
    config, found = check(whole.plain(), kept=kept)
    everything = [*problems, *overridden.blamed(document, issues)]
    told = unread_maps(whole)
    found = [issue for issue in found if issue.path[:2] not in broken and issue.path[:3] not in told]
    everything += overridden.blamed(whole, found)
    if not everything and config is not None:
        config, found = (config, []) if kept else _with_known_names(config, overridden.written)
        found += _otherwise_read_back(config, kept=kept)
        everything = [positioned(whole, issue) for issue in found]
    if everything or config is None:
        raise failure(everything)
    return config


def _with_known_names(config: Config, written: Node) -> tuple[Config, list[Issue]]:
    """The config whose figure says nothing of what overrides have left out, and what else it says of nobody."""
    if config.figure is None:
        return config, []
    of = ("experiments", "agents", "humans")
    unknown = config.figure.unknown({name for section in of for name in getattr(config, section)})
    there = {name for section in of if (node := written.child(section)) for name in node.entries()}
    gone = {name for _, name in unknown} & there
    known = config.model_copy(update={"figure": config.figure.without(gone)})
    return known, [
        Issue(
            ("figure", *place),
            f"no experiment, agent or human is called {name}{or_else(name, sorted(there))}",
            at="key" if place[-1] == name else "value",
        )
        for place, name in unknown
        if name not in gone
    ]


def _otherwise_read_back(config: Config, *, kept: bool) -> Iterator[Issue]:
    """What a run's folder would not keep as it is: a kind of agent may read its settings otherwise than it tells them.

    Such a run could be made, and would then be called edited.
    """
    plain = canonical(config)
    again, issues = check(plain, kept=kept)
    if again is None:
        yield from (replace(issue, message=f"{NOT_KEPT}: {issue.message}") for issue in issues)
    else:
        told = canonical(again)
        wrong = [
            (section, name)
            for section in SECTIONS
            for name, entry in plain[section].items()
            if told[section][name] != entry or getattr(again, section)[name] != getattr(config, section)[name]
        ]
        yield from (Issue(path, NOT_KEPT, at="key") for path in wrong)


def _declared(plain: Plain, model: type[Config]) -> Declared:
    """What can be checked between the parts of a config that is partly wrong."""
    humans, agents, experiments, labs = (_valid_entries(model, section, plain.get(section)) for section in SECTIONS)
    expected = plain.get("expected") if not plain.get("vary") else None
    return Declared(humans, agents, experiments, expected if isinstance(expected, dict) else (), labs=labs)


@cache
def _entry(model: type[Config], section: str) -> TypeAdapter[Any]:
    """What checks an entry of a section alone."""
    _, entry = get_args(model.model_fields[section].annotation)
    return TypeAdapter(entry)


def _valid_entries(model: type[Config], section: str, entries: Plain) -> dict[str, Any]:
    valid: dict[str, Any] = {}
    for name, entry in entries.items() if isinstance(entries, dict) else ():
        try:
            valid[name] = _entry(model, section).validate_json(json.dumps(entry), strict=True)
        except ValidationError:
            valid[name] = None
    return valid


def _with_whole_modules(config: Config) -> Config:
    """The config with the human of each social module and the numbers of goal rooms: one setting has one spelling."""
    experiments = {
        name: each.with_whole_modules(config.experiments).in_labs(config.labs)
        for name, each in config.experiments.items()
    }
    return config.model_copy(update={"experiments": experiments})
