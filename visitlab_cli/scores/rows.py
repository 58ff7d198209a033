"""The rows of a scorecard as data: questions, the cells that answer them, what is measured, what counts as 1.

They lie in YAML files, in the order of their names; `configs/scores/00_shared.yaml` says what may stand in one.
"""

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import Field, JsonValue, ValidationError

from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.names import Name
from visitlab_cli.errors import NotFoundError
from visitlab_cli.settings import Settings
from visitlab_cli.yaml.document import Node
from visitlab_cli.yaml.files import read_file
from visitlab_cli.yaml.problems import Issue, Problem, failure, positioned

AGENT = "AGENT"
"""Stands in the rows for the agent that is scored."""
SECTIONS = ("humans", "agents", "experiments", "optima")
"""What the files add to one another; a name has one meaning in all of them."""

Measure = Literal["level", "all", "cpu", "updates"]
COSTS: dict[str, str] = {"cpu": "µs of a core a step", "updates": "values updated a step"}
"""What has no score, and its unit."""
CellGroup = Annotated[str, Field(pattern=r"^[^/]+(/[^/]+){1,2}$")]


class Known(Settings):
    """The best that is known where nobody knows the optimum."""

    value: float
    source: str = Field(min_length=1)


class Row(Settings):
    """A question; `of` are the groups of cells, `experiment/agent/human`, whose scores it is the mean of."""

    question: str = Field(min_length=1)
    of: tuple[CellGroup, ...] = Field(min_length=1)
    measure: Measure
    best: Literal["optimum"] | Known | None = None

    @property
    def scored(self) -> bool:
        """Whether it has a score, beside a value."""
        return self.measure not in COSTS


class _File(Settings):
    set: int = Field(ge=1)
    humans: dict[Name, JsonValue] = {}
    agents: dict[Name, JsonValue] = {}
    experiments: dict[Name, JsonValue] = {}
    optima: dict[Name, float] = {}
    rows: dict[Name, Row] = {}


class Rows(NamedTuple):
    """A set of rows: its `number`, the rows by name, and the parts of a config that they share, as plain values."""

    number: int
    rows: Mapping[str, Row]
    humans: Mapping[str, Any]
    agents: Mapping[str, Any]
    experiments: Mapping[str, Any]
    optima: Mapping[str, float]

    @property
    def digest(self) -> str:
        """8 hex digits of all that decides a score of theirs."""
        plain = [{name: row.model_dump(mode="json") for name, row in self.rows.items()}, *map(dict, self[2:])]
        return hashlib.sha256(json.dumps(plain, sort_keys=True).encode()).hexdigest()[:8]

    @property
    def label(self) -> str:
        """What a score of theirs is to be quoted with."""
        return f"set {self.number} ({self.digest})"


def shipped_rows() -> Path:
    """The folder of visitlab's own rows."""
    return shipped_folder() / "scores"


def read_rows(folder: Path | None = None) -> Rows:
    """The rows in a folder's YAML files, visitlab's own unless given.

    Raises:
        NotFoundError: there are none.
        ConfigError: a line for each thing that is wrong in them.
    """
    folder = folder or shipped_rows()
    files = sorted(folder.glob("*.yaml")) if folder.is_dir() else []
    documents = [read_file(file) for file in files]
    problems = [problem for _, found in documents for problem in found]
    parsed = [(node, _parsed(node, problems)) for node, _ in documents]
    if problems:
        raise failure(problems)
    sections: dict[str, dict[str, Any]] = {name: {} for name in (*SECTIONS, "rows")}
    for node, file in parsed:
        assert file is not None
        for section, found in sections.items():
            for name, entry in getattr(file, section).items():
                if found.setdefault(name, entry) != entry:
                    problems.append(positioned(node, Issue((section, name), "is something else in another file")))
    if not sections["rows"] and not problems:
        raise NotFoundError(f"{folder}: no rows of a scorecard there (YAML files with `rows`)")
    rows = Rows(max(file.set for _, file in parsed if file is not None), sections.pop("rows"), **sections)
    for node, file in parsed:
        problems += [positioned(node, issue) for name in file.rows for issue in _issues(rows, name)] if file else []
    if problems:
        raise failure(problems)
    return rows


def _parsed(node: Node, problems: list[Problem]) -> _File | None:
    try:
        return _File.model_validate_json(json.dumps(node.plain()))
    except ValidationError as error:
        for each in error.errors(include_url=False):
            message = "unknown" if each["type"] == "extra_forbidden" else each["msg"][:1].lower() + each["msg"][1:]
            problems.append(positioned(node, Issue(tuple(each["loc"]), message)))
        return None


def _issues(rows: Rows, name: str) -> Iterator[Issue]:
    row = rows.rows[name]
    for number, group in enumerate(row.of):
        if group.split("/")[0] not in rows.experiments:
            yield Issue(("rows", name, "of", number), f"no experiment is called {group.split('/')[0]}")
    if row.scored and row.best is None:
        yield Issue(("rows", name), "needs `best`: optimum, or a value and its source")
