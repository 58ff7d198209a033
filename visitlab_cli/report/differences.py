"""The agents two by two: which leads better, by how much, and how sure that is."""

from collections.abc import Mapping

from visitlab_cli.report.facts import Facts, counted
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.report.sections import section
from visitlab_cli.results.pairs import Pair
from visitlab_cli.results.varying import varying

MOST_PAIRS = 40
HEADS = ("Where", "Agents", "Difference", "n", "Improves")
NOTE = (
    "Last tenth of trials, one agent less the other, with half its 95% interval (Student's t; Welch's where seeds are "
    "independent). Improves: the probability that a seed of the one is better than one of the other; a tie is half."
)


def differences(facts: Facts, title: str) -> Html | None:
    """A line for each two agents that differ in nothing else; None where there are none."""
    if not facts.pairs:
        return None
    shown, more = facts.pairs[:MOST_PAIRS], len(facts.pairs) - MOST_PAIRS
    short = varying(line.group.point for line in facts.summaries).heads
    rows = [_row(pair, short) for pair in shown]
    table = element(
        "table",
        element("thead", element("tr", *(element("th", text, scope="col") for text in HEADS))),
        element("tbody", *rows),
        class_="stacked",
    )
    rest = f"{counted(more, 'pair')} more: visitlab compare {facts.name} --by agent"
    left_out = element("p", rest, class_="note") if more > 0 else None
    return section("differences", title, element("p", NOTE, class_="note"), table, left_out)


def _row(pair: Pair, short: Mapping[str, str]) -> Html:
    cells: list[str] = [
        _words(f"{pair.second.name} less {pair.first.name}", short),
        element("b", pair.difference.in_words("+", unknown="")),
        f"{pair.n} {'paired' if pair.paired else 'independent'}",
        f"{pair.probability_of_improvement:.2f}",
    ]
    where = element("th", _words(pair.where, short), element("small", pair.measure), scope="row")
    measured = (element("td", cell, data_label=head) for head, cell in zip(HEADS[1:], cells, strict=True))
    return element("tr", where, *measured)


def _words(names: str, short: Mapping[str, str]) -> Html:
    """Names and settings, each of which stays in one line where it can, and its value always."""
    spans = []
    for word in names.split():
        path, equals, value = word.rpartition("=")
        name, value = (path, value) if equals else ("", word)
        number = any(letter.isdigit() for letter in value) and not any(letter.isalpha() for letter in value)
        told = element("span", value) if number else breakable(value)
        spans.append(element("span", breakable(short.get(name, name) + equals), told))
    return element("span", *spans, class_="words")
