"""Tables whose rows a reader chooses and sorts: read as they are without a script, as cards on a phone."""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.results.varying import NOTHING

UNKNOWN = "–"
SHORT = 13  # letters of a value that fit into the column of a card


class Row(NamedTuple):
    """A row: the number of its line among the page's choices, and its cells, the first of which names it."""

    line: int
    cells: Sequence[Html]


class Body(NamedTuple):
    """Rows that belong together under a title, beside which stands what is measured."""

    title: str
    measure: str
    rows: Sequence[Row]


def table(name: str, heads: Sequence[str], bodies: Sequence[Body]) -> Html:
    """A table that says its `name` to those who do not see it; too wide for the page, it is moved sideways."""
    whole = element(
        "table",
        element("caption", name, class_="unseen"),
        element("thead", element("tr", *(element("th", breakable(text), scope="col") for text in heads))),
        *(_body(body, heads) for body in bodies),
        class_="numbers",
    )
    return element("div", whole, class_="frame", role="group", aria_label=f"Table: {name}")


def _body(body: Body, heads: Sequence[str]) -> Html:
    title = element(
        "th", breakable(body.title), " ", element("small", body.measure), scope="rowgroup", colspan=len(heads)
    )
    rows = []
    for line, (first, *others) in body.rows:
        told = (
            element("td", cell, data_label=head, class_=_class(cell))
            for head, cell in zip(heads[1:], others, strict=True)
        )
        rows.append(element("tr", element("th", first, scope="row"), *told, data_line=line))
    return element("tbody", element("tr", title, class_="group"), *rows)


def _class(cell: Html) -> str | None:
    if cell == UNKNOWN:
        return "none"
    return "long" if "<" not in cell and len(cell) > SHORT else None


def setting(value: str) -> Html:
    """A value of a column of what varies; numbers are never broken."""
    if value in ("", NOTHING):
        return Html(UNKNOWN)
    words = breakable(value)
    return element("span", words, class_="text") if any(letter.isalpha() for letter in value) else words


def agent_named(name: str, hues: Mapping[str, int], words: str | None = None) -> Html:
    """An agent, or other words for it, beside its colour; a name that has none stands alone."""
    told = breakable(words or name)
    if name not in hues:
        return element("span", told, class_="text")
    return element("span", element("i", class_=f"colour-{hues[name]}", aria_hidden="true"), told, class_="agent")
