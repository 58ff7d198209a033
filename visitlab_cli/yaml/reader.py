"""YAML text to nodes with their places, in one pass over the parser's events.

Refused are aliases (and with them alias bombs), tags, a second document, deep nesting, more values than any config
has, keys that are doubled or not text, and line breaks that only YAML 1.1 takes for such, as our parser does.
"""

import re
import unicodedata
from collections.abc import Iterator
from typing import Any, NoReturn

import yaml

from visitlab_cli.wording import shown
from visitlab_cli.yaml.document import Node, Place
from visitlab_cli.yaml.problems import Problem, failure
from visitlab_cli.yaml.scalars import meaning

DEEPEST = 32
MOST_VALUES = 20_000
_OLD_BREAK = re.compile("[\u0085\u2028\u2029]")
_ODD_SPACE = re.compile("[\u00a0\u00ad\u1680\u180e\u2000-\u200f\u202a-\u202f\u205f-\u2064\u3000\ufeff]")
"""What looks like a space, or like nothing, and is neither to YAML."""

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_yaml(text: str, source: str, *, lines: bool = True) -> tuple[Node | None, list[Problem]]:
    """The document (None if there is none), and what was wrong with its keys.

    Args:
        text: YAML.
        source: what to call it in messages.
        lines: whether places have lines and columns.

    Raises:
        ConfigError: one line, if it cannot be read any further.
    """
    reader = _Reader(text, source, lines)
    if old := _OLD_BREAK.search(text):
        reader.stop(f"{_named(old[0])}, which some take for a line break; remove it", _mark(text, old.start()))
    try:
        return reader.document(), reader.problems
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        if odd := _odd_space(text, error):
            reader.stop(f"{_named(text[odd])}; YAML knows no other space than the usual one", _mark(text, odd))
        reader.stop(_in_our_words(error, mark, text), mark)
    except yaml.reader.ReaderError as error:
        before = text.encode()[: error.position].decode(errors="ignore")
        reader.stop(f"a character that YAML does not allow: {shown(chr(error.character))}", _mark(text, len(before)))
    except UnicodeEncodeError:
        reader.stop("not UTF-8", (0, 0))


def _mark(text: str, position: int) -> tuple[int, int]:
    """Line and column of a place in a text, from 0."""
    lines = _lines(text[:position])
    return len(lines) - 1, len(lines[-1])


def _lines(text: str) -> list[str]:
    return re.split("\r\n?|\n", text)


def _named(character: str) -> str:
    return f"{unicodedata.name(character, 'control character').lower()} (U+{ord(character):04X})"


def _odd_space(text: str, error: yaml.MarkedYAMLError) -> int | None:
    """Where, in the lines that an error is about, there is something that looks like a space and is none."""
    marks = [mark for mark in (error.context_mark, error.problem_mark) if mark is not None]
    if not marks:
        return None
    ends = [0, *(found.end() for found in re.finditer("\r\n?|\n", text)), len(text)]
    first = max(min(mark.line for mark in marks) - 1, 0)  # what is wrong may have begun with the line before
    last = max(mark.line for mark in marks)
    if first + 1 >= len(ends):
        return None
    odd = _ODD_SPACE.search(text, ends[first], ends[min(last + 1, len(ends) - 1)])
    return None if odd is None else odd.start()


def _in_our_words(error: yaml.MarkedYAMLError, mark: Any, text: str) -> str:
    lines = _lines(text)
    rest = lines[mark.line][mark.column :] if mark and mark.line < len(lines) else ""
    if rest.startswith("\t"):
        return "a tab; YAML is indented with spaces"
    if rest[:1] in ("@", "`", "%"):
        return f"text that starts with {rest[0]} must be in quotes"
    context = error.context or ""
    begun = error.context_mark
    if context and begun and (begun.line, begun.column) != (mark.line, mark.column):
        context += f" that begins at line {begun.line + 1}, column {begun.column + 1}"
    return f"not YAML: {context}: {error.problem}" if context else f"not YAML: {error.problem}"


class _Reader:
    def __init__(self, text: str, source: str, lines: bool) -> None:
        self.source, self.lines, self.rows = source, lines, _lines(text)
        self.events: Iterator[Any] = iter(yaml.parse(text, Loader=_Loader))
        self.problems: list[Problem] = []
        self.values = 0

    def place(self, mark: Any) -> Place:
        line, column = mark if isinstance(mark, tuple) else (mark.line, mark.column)
        return Place(self.source, line + 1, column + 1) if self.lines else Place(self.source)

    def stop(self, message: str, mark: Any) -> NoReturn:
        raise failure([*self.problems, Problem(self.place(mark), (), message)])

    def document(self) -> Node | None:
        next(self.events)  # the stream's start
        if isinstance(next(self.events), yaml.StreamEndEvent):
            return None
        node = self.node(next(self.events), 0, None)
        next(self.events)  # the document's end
        after = next(self.events)
        if not isinstance(after, yaml.StreamEndEvent):
            self.stop("a second document; a config is one", after.start_mark)
        return node

    def node(self, event: Any, depth: int, key: Place | None) -> Node:
        if isinstance(event, yaml.AliasEvent):
            self.stop(f"an alias (*{event.anchor}); use `like` or `include`", event.start_mark)
        if event.tag is not None:
            self.stop(f"a tag ({shown(event.tag)}); a config has none", event.start_mark)
        self.values += 1
        if self.values > MOST_VALUES:
            self.stop(f"more than {MOST_VALUES} values; no config has so many", event.start_mark)
        if depth > DEEPEST:
            self.stop(f"nested more than {DEEPEST} deep", event.start_mark)
        place = self.place(event.start_mark)
        if isinstance(event, yaml.MappingStartEvent):
            return Node(self.mapping(depth), place, key)
        if isinstance(event, yaml.SequenceStartEvent):
            return Node(self.sequence(depth), place, key)
        return Node(self.scalar(event), place, key, self.block(event))

    def block(self, event: Any) -> Place | None:
        """Where the first line of a text begins that is written below its key, after `|`."""
        if event.style != "|" or not self.lines:
            return None
        line = event.start_mark.line + 1
        while line + 1 < len(self.rows) and not self.rows[line].strip():
            line += 1
        first = self.rows[line] if line < len(self.rows) else ""
        return Place(self.source, line + 1, len(first) - len(first.lstrip(" ")) + 1)

    def scalar(self, event: Any) -> Any:
        if not event.implicit[0]:
            return event.value
        try:
            return meaning(event.value)
        except ValueError as error:
            self.stop(str(error), event.start_mark)

    def sequence(self, depth: int) -> list[Node]:
        entries = []
        while not isinstance(event := next(self.events), yaml.SequenceEndEvent):
            entries.append(self.node(event, depth + 1, None))
        return entries

    def mapping(self, depth: int) -> dict[str, Node]:
        entries: dict[str, Node] = {}
        while not isinstance(event := next(self.events), yaml.MappingEndEvent):
            key = self.node(event, depth + 1, None)
            value = self.node(next(self.events), depth + 1, key.place)
            if not isinstance(key.value, str):
                self.problem(key, f"a key must be text (got {shown(key.plain())}{_quotes(key)})")
            elif key.value in entries:
                self.problem(key, f"{shown(key.value)} a second time; first at {entries[key.value].key}")
            else:
                entries[key.value] = value
        return entries

    def problem(self, key: Node, message: str) -> None:
        self.problems.append(Problem(key.place, (), message))


def _quotes(key: Node) -> str:
    return "" if isinstance(key.value, dict | list) else "; put it in quotes"
