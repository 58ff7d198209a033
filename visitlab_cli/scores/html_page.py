"""A scorecard as one HTML page, in the report's looks: every row with its interval drawn, for each agent."""

from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.colours import looks_of
from visitlab_cli.origin import HTML
from visitlab_cli.pictures.style import write
from visitlab_cli.report.facts import counted
from visitlab_cli.report.interval import Scale, picture, scale_of
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.report.page import STYLES, header, joined, palette
from visitlab_cli.report.sections import section
from visitlab_cli.report.tables import UNKNOWN
from visitlab_cli.scores.judging import Card, Line, Scorecard
from visitlab_cli.scores.words import number, row_words, score_words, value_words

WHOLE = (-0.05, 1.05)
"""What the pictures of scores show at least."""
HEADS = ("Row", "Score", "Value", "Random", "Best", "What is best", "n")


def save_report(card: Scorecard, target: Path) -> None:
    """Write the page whole or not at all; the same bytes for the same scores.

    Raises:
        UsageError: what is there is not visitlab's.
        RunError: it cannot be written.
    """
    write(target, render(card).encode())


def render(card: Scorecard) -> str:
    """The page as text; it asks the network for nothing and runs no script."""
    names = [each.agent for each in card.cards]
    title = f"Scores of {names[0]}" if len(names) == 1 else f"Scores of {counted(len(names), 'agent')}"
    links = [element("a", name, href=f"#agent-{place}") for place, name in enumerate(names)]
    style = Html(palette() + joined(STYLES))
    body = element(
        "body",
        element(
            "header",
            element("p", "visit the lab", class_="eyebrow"),
            element("h1", title),
            element("p", f"rows of {card.rows} · {counted(card.seeds, 'seed')}", class_="facts"),
            element("nav", element("a", "All", href="#all"), *links, aria_label="Parts of this page"),
        ),
        element("main", _all(card), *_agents(card)),
        element("footer", "Written by visitlab score. This page asks the network for nothing."),
    )
    return f'{HTML}<html lang="en">{header(title, style, Html(""))}{body}</html>\n'


def _all(card: Scorecard) -> Html:
    """The scores of all agents beside one another."""
    about = (
        "0 is what random actions reach on the same cells, 1 the exact optimum of whoever sees the whole state, or the "
        "best that is known where nobody knows it; the tables below say which. Mean over seeds ± half its 95% interval "
        "(Student's t); of costs there is no score, but the value."
    )
    looks = looks_of(each.agent for each in card.cards)
    heads = [element("th", _agent(each.agent, looks[each.agent].hue), scope="col") for each in card.cards]
    rows = [
        element(
            "tr",
            element("th", row_words(line.row), element("small", line.question), scope="row"),
            *(element("td", _short(each.lines[place]), data_label=each.agent) for each in card.cards),
        )
        for place, line in enumerate(card.cards[0].lines)
    ]
    table = element(
        "table",
        element("thead", element("tr", element("th", "Row", scope="col"), *heads)),
        element("tbody", *rows),
        class_="stacked",
    )
    return section("all", "All scores", element("p", about, class_="about"), table)


def _agent(name: str, hue: int) -> Html:
    return element("span", element("i"), breakable(name), class_=f"agent colour-{hue}")


def _short(line: Line) -> str:
    told = line.score if line.scored else line.value
    return UNKNOWN if told is None else score_words(told)


def _agents(card: Scorecard) -> Iterator[Html]:
    for place, each in enumerate(card.cards):
        yield section(f"agent-{place}", each.agent, _about(each), _table(each))


def _about(card: Card) -> Html:
    settings = ", ".join(f"{name}={value}" for name, value in card.parameters.items() if value is not None)
    told: list[str] = [f"Kind {card.kind}{f' with {settings}' if settings else ''}."]
    if card.run is not None:
        command = f"visitlab report {card.run.name}"
        told += [f" All that it played is in {card.run.name}; ", element("code", command), " makes a page of it."]
    return element("p", *told, class_="about")


def _table(card: Card) -> Html:
    least, most = scale_of(line.score for line in card.lines)
    scale = min(least, WHOLE[0]), max(most, WHOLE[1])
    rows = [_row(line, scale) for line in card.lines]
    return element(
        "table",
        element("thead", element("tr", *(element("th", text, scope="col") for text in HEADS))),
        element("tbody", *rows),
        class_="stacked",
    )


def _row(line: Line, scale: Scale) -> Html:
    name = element("th", row_words(line.row), element("small", line.question), scope="row")
    if line.reason:
        return element("tr", name, element("td", line.reason, colspan=len(HEADS) - 1, data_label="Score"))
    score: list[str] = [Html(UNKNOWN)]
    if line.score is not None:
        score = [element("b", number(line.score.mean)), picture(line.score, scale)]
    cells = (
        ("Value", [value_words(line.value), element("small", line.unit)]),
        ("Random", [UNKNOWN if line.random is None else number(line.random)]),
        ("Best", [UNKNOWN if line.best is None else number(line.best)]),
        ("What is best", [line.best_is or UNKNOWN]),
        ("n", [f"{line.n}"]),
    )
    told = (element("td", *content, data_label=head) for head, content in (("Score", score), *cells))
    return element("tr", name, *told)
