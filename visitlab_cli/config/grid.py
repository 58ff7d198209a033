"""`vary`: a config as a grid of configs."""

import itertools
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from visitlab_cli.config.building import check
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.document import Node, split_path
from visitlab_cli.config.experiments import Visit
from visitlab_cli.config.model import Config
from visitlab_cli.config.problems import Issue, dotted, failure, nearest_name, or_else, positioned, printable
from visitlab_cli.errors import ConfigError
from visitlab_cli.settings import at_default

MOST_POINTS = 100_000
MOST_CELLS = 1_000_000
LONGEST_LABEL = 40
SECTIONS = ("humans", "agents", "experiments", "interaction")
"""What may vary."""


class Variant(NamedTuple):
    """One point of the grid: its values by dotted path, and the config there, which varies no more."""

    values: dict[str, Any]
    config: Config


def variants(config: Config) -> Iterator[Variant]:
    """The points of the grid in order, the last path fastest; without `vary` the config itself.

    Raises:
        ConfigError: at a point whose values are not valid together.
    """
    if not config.vary:
        yield Variant({}, config)
        return
    for values in itertools.product(*config.vary.values()):
        point = dict(zip(config.vary, values, strict=True))
        found, issues = check(_at(config, point))
        if found is None:
            where = ", ".join(f"{path}={value}" for path, value in point.items())
            raise ConfigError(f"vary: at {where}: {dotted(issues[0].path)}: {issues[0].message}")
        yield Variant(point, found)


def label(path: str, value: Any, values: Sequence[Any]) -> str:
    """A folder's name for a `value` among a path's: `path=value`, or `path=index` where that is unsafe."""
    texts = [_text(each) for each in values]
    plain = all(texts) and len({str(text).lower() for text in texts}) == len(texts)
    return f"{path}={_text(value) if plain else list(values).index(value)}"


def value_in_words(value: Any) -> str:
    """A value of a grid as a reader sees it: text as it is, all else as JSON."""
    return value if isinstance(value, str) else json.dumps(value)


def _text(value: Any) -> str | None:
    words = {None: "null", True: "true", False: "false"}
    text = words[value] if value is None or isinstance(value, bool) else str(value).replace("+", "")
    return text if re.fullmatch(rf"[A-Za-z0-9._=-]{{1,{LONGEST_LABEL}}}", text) else None


def _at(config: Config, point: dict[str, Any]) -> dict[str, Any]:
    """The plain config at a point; it has no expected values, which are the unvaried config's."""
    plain = canonical(config)
    plain["vary"], plain["expected"] = {}, {}
    for experiment in plain["experiments"].values():
        for option in Visit.planning_options:  # a point may have a social module that does not plan
            if experiment.get(option) == getattr(Visit.model_fields.get(option), "default", None):
                experiment.pop(option, None)
    whole = canonical(config)
    for path, value in point.items():
        *parts, last = split_path(whole, path)
        target = plain
        _forget_defaults(config, parts, last, plain)
        for part in parts:
            target = target[part]
        target[last] = value
    return plain


def _forget_defaults(config: Config, parts: Sequence[str], last: str, plain: dict[str, Any]) -> None:
    """Where an agent's kind or an experiment's task varies, the defaults of what it was are not taken along."""
    if len(parts) != 2 or (parts[0], last) not in (("agents", "kind"), ("experiments", "task")):
        return
    section, name = parts
    for key in at_default(getattr(config, section)[name]):
        plain[section][name].pop(key, None)


def with_checked_grid(config: Config, document: Node) -> Config:
    """The config with each value of `vary` checked at its path, and as it is there (1 may become 1.0).

    Raises:
        ConfigError: for a path that is not there, a value that is not valid there, a grid too large.
    """
    points = math.prod(len(values) for values in config.vary.values())
    if points > MOST_POINTS:
        message = f"a grid of {points} points; at most {MOST_POINTS}"
        raise failure([positioned(document, Issue(("vary",), message, at="key"))])
    cells = points * sum(_cells(experiment, config.seeds) for experiment in config.experiments.values())
    if cells > MOST_CELLS:
        message = f"makes up to {cells} cells; at most {MOST_CELLS}"
        raise failure([positioned(document, Issue(("vary" if points > 1 else "seeds",), message, at="key"))])
    checked = {path: _checked_path(config, path) for path in config.vary}
    issues = [issue for _, found in checked.values() for issue in found]
    if issues:
        raise failure(positioned(document, issue) for issue in issues)
    return config.model_copy(update={"vary": {path: values for path, (values, _) in checked.items()}})


def _cells(experiment: Any, seeds: int) -> int:
    models = seeds if getattr(experiment, "models", None) == "crossed" else 1
    return len(getattr(experiment, "agents", "1")) * len(getattr(experiment, "humans", "1")) * models * seeds


def _checked_path(config: Config, path: str) -> tuple[tuple[Any, ...], list[Issue]]:
    plain = canonical(config)
    parts = split_path(plain, path)
    wrong = _wrong_path(plain, parts) or _overlap(path, config.vary)
    if wrong:
        return (), [Issue(("vary", path), wrong, at="key")]
    values: list[Any] = []
    issues: list[Issue] = []
    for index, value in enumerate(config.vary[path]):
        found, problems = check(_at(config, {path: value}))
        for problem in problems:
            where = "" if problem.path == tuple(parts) else f"{dotted(problem.path)}: "
            issues.append(Issue(("vary", path, index), where + problem.message))
        if found is not None:
            values.append(_value(canonical(found), parts))
            if values[-1] in values[:-1]:
                issues.append(Issue(("vary", path, index), "the same value a second time"))
    return tuple(values), issues


def _wrong_path(plain: Any, parts: Sequence[str]) -> str | None:
    """Why there is nothing to vary at a path, if so."""
    if parts[0] not in SECTIONS:
        return f"only {', '.join(SECTIONS)} can vary"
    for depth, part in enumerate(parts):
        if not isinstance(plain, dict) or part not in plain:
            known = list(plain) if isinstance(plain, dict) else []
            near = nearest_name(part, known)
            whole = dotted((*parts[:depth], near or "", *parts[depth + 1 :]))
            all_known = or_else(None, known) if known else ""
            instead = f"; did you mean {whole}?" if near else all_known
            return f"there is no {dotted(tuple(parts[: depth + 1]))}{instead}"
        plain = plain[part]
    return None if len(parts) > 1 else "must lead to a setting inside a section"


def _overlap(path: str, others: Iterable[str]) -> str | None:
    outer = [other for other in others if path.startswith(f"{other}.")]
    return f"lies within {printable(outer[0])}, which varies too" if outer else None


def _value(plain: Any, parts: Sequence[str]) -> Any:
    for part in parts:
        plain = plain[part]
    return plain
