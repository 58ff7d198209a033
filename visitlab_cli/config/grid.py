"""`vary`: a config as a grid of configs."""

import hashlib
import itertools
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

from visitlab_cli.config.building import check
from visitlab_cli.config.canonical import canonical
from visitlab_cli.config.goal_rooms import ALL, numbered
from visitlab_cli.config.model import Config
from visitlab_cli.config.names import PAPER_LAB
from visitlab_cli.config.visits import Visit
from visitlab_cli.errors import ConfigError
from visitlab_cli.kinds import KIND
from visitlab_cli.settings import at_default
from visitlab_cli.wording import nearest_name, or_else, printable
from visitlab_cli.yaml.document import Node, split_path
from visitlab_cli.yaml.problems import Issue, dotted, failure, positioned

MOST_POINTS = 10_000
MOST_CELLS = 100_000
MOST_VALUES = 3_000_000
"""Of all points' configs together: what takes seconds to check, not hours."""
LONGEST_LABEL = 40
LONGEST_FOLDER_NAME = 200
LONGEST_PATH = 1000
MOST_PATHS = 64
LONGEST_COUNT = 10**15
SECTIONS = ("humans", "labs", "agents", "experiments", "interaction")
"""What may vary."""


class Variant(NamedTuple):
    """One point of the grid: its values by path, their names in folders, and the config, which varies no more."""

    values: dict[str, Any]
    labels: dict[str, str]
    config: Config

    def values_of(self, used: set[str]) -> dict[str, Any]:
        """Those values that lie in a `used` part of the config, by path."""
        return {
            path: value
            for path, value in self.values.items()
            if any(path == part or path.startswith(part + ".") for part in used)
        }

    def labels_of(self, used: set[str]) -> str:
        """Their names."""
        joined = ",".join(self.labels[path] for path in self.values_of(used))
        if len(joined) <= LONGEST_FOLDER_NAME:
            return joined
        return f"vary-{hashlib.sha256(joined.encode()).hexdigest()[:8]}"


def variants(config: Config) -> Iterator[Variant]:
    """The points of the grid in order, the last path fastest; without `vary` the config itself.

    Raises:
        ConfigError: at a point whose values are not valid together.
    """
    if not config.vary:
        yield Variant({}, {}, config)
        return
    named = [list(zip(values, labels(path, values), strict=True)) for path, values in config.vary.items()]
    frame = _Frame(config)
    for point in itertools.product(*named):
        values = {path: value for path, (value, _) in zip(config.vary, point, strict=True)}
        found, issues = check(frame.at(values), kept=True)
        if found is None:
            where = ", ".join(f"{path}={value}" for path, value in values.items())
            raise ConfigError(f"vary: at {where}: {dotted(issues[0].path)}: {issues[0].message}")
        yield Variant(values, {path: name for path, (_, name) in zip(config.vary, point, strict=True)}, found)


def labels(path: str, values: Sequence[Any]) -> list[str]:
    """Folders' names for a path's `values`: each `path=value`, or `path=index` where one of them is unsafe."""
    texts = [_text(each) for each in values]
    plain = all(texts) and len({str(text).lower() for text in texts}) == len(texts)
    return [f"{path}={text if plain else index}" for index, text in enumerate(texts)]


def value_in_words(value: Any) -> str:
    """A value of a grid as a reader sees it: text as it is, all else as JSON."""
    return value if isinstance(value, str) else json.dumps(value)


def _text(value: Any) -> str | None:
    words = {None: "null", True: "true", False: "false"}
    text = words[value] if value is None or isinstance(value, bool) else str(value).replace("+", "")
    return text if re.fullmatch(rf"[A-Za-z0-9._=-]{{1,{LONGEST_LABEL}}}", text) else None


class _Frame:
    """A config that varies as plain values, into which those of one point after the other are put."""

    def __init__(self, config: Config) -> None:
        self.config, self.whole = config, canonical(config)
        self.bare = canonical(config)
        self.bare["vary"], self.bare["expected"] = {}, {}  # the expected values are the unvaried config's
        for experiment in self.bare["experiments"].values():
            for option in Visit.planning_options:  # a point may have a social module that does not plan
                if experiment.get(option) == getattr(Visit.model_fields.get(option), "default", None):
                    experiment.pop(option, None)
            if experiment.get("goal_rooms") == list(numbered(ALL, PAPER_LAB, {})):  # a point may be in another lab
                experiment.pop("goal_rooms")

    def at(self, point: dict[str, Any]) -> dict[str, Any]:
        """The plain config at a point; what a path leads through is a copy."""
        plain = self.bare.copy()
        for path, value in point.items():
            *parts, last = split_path(self.whole, path)
            target = plain
            for part in parts:
                target[part] = target[part].copy()
                target = target[part]
            _forget_defaults(self.config, parts, last, plain)
            target[last] = value
        return plain

    def size(self) -> int:
        """How many values a point has."""
        return _size(self.bare)


def _size(plain: Any) -> int:
    inner = plain.values() if isinstance(plain, dict) else plain if isinstance(plain, list) else ()
    return 1 + sum(map(_size, inner))


def _forget_defaults(config: Config, parts: Sequence[str], last: str, plain: dict[str, Any]) -> None:
    """Where an entry's kind or an experiment's task varies, the defaults of what it was are not taken along."""
    if len(parts) != 2 or (parts[0], last) not in (("humans", KIND), ("agents", KIND), ("experiments", "task")):
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
    cells = points * sum(_cells(experiment, config.seeds) for experiment in config.experiments.values())
    frame = _Frame(config)
    for count, message, most in (
        (len(config.vary), "{} paths; at most {}", MOST_PATHS),
        (points, "a grid of {} points; at most {}", MOST_POINTS),
        (cells, "makes up to {} cells; at most {}", MOST_CELLS),
        (points * frame.size() if config.vary else 0, "all points together have {} values; at most {}", MOST_VALUES),
    ):
        if count > most:
            shown = count if count < LONGEST_COUNT else f"more than {LONGEST_COUNT}"
            at = "vary" if config.vary else "seeds"
            raise failure([positioned(document, Issue((at,), message.format(shown, most), at="key"))])
    checked = {path: _checked_path(frame, path) for path in config.vary}
    issues = [issue for _, found in checked.values() for issue in found]
    if issues:
        raise failure(positioned(document, issue) for issue in issues)
    return config.model_copy(update={"vary": {path: values for path, (values, _) in checked.items()}})


def _cells(experiment: Any, seeds: int) -> int:
    models = seeds if experiment.crossed else 1
    return max(1, len(experiment.trained)) * max(1, len(experiment.met)) * models * seeds


def _checked_path(frame: _Frame, path: str) -> tuple[tuple[Any, ...], list[Issue]]:
    if len(path) > LONGEST_PATH:
        return (), [Issue(("vary", path), f"a path of more than {LONGEST_PATH} characters", at="key")]
    parts = split_path(frame.whole, path)
    wrong = _wrong_path(frame.whole, parts) or _overlap(path, frame.config.vary)
    if wrong:
        return (), [Issue(("vary", path), wrong, at="key")]
    values: list[Any] = []
    seen: set[str] = set()
    issues: list[Issue] = []
    for index, value in enumerate(frame.config.vary[path]):
        found, problems = check(frame.at({path: value}))
        for problem in problems:
            where = "" if problem.path == tuple(parts) else f"{dotted(problem.path)}: "
            issues.append(Issue(("vary", path, index), where + problem.message))
        if found is not None:
            values.append(_value(canonical(found), parts))
            text = json.dumps(values[-1], sort_keys=True)
            if text in seen:
                issues.append(Issue(("vary", path, index), "the same value a second time"))
            seen.add(text)
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
