"""A scorecard in words: a row's name, a score, the tables that a terminal and a page show."""

import math
from collections.abc import Sequence

from visitlab_cli.results.estimates import Estimate
from visitlab_cli.scores.judging import Card, Line, Scorecard

NOTHING = "-"


def row_words(row: str) -> str:
    """A row's name as it is read."""
    return row.replace("_", " ")


def score_words(estimate: Estimate | None) -> str:
    """A score, or a cost, with half its interval: two digits, for finer differences are none that matter."""
    if estimate is None or math.isnan(estimate.half):
        return number(estimate and estimate.mean)
    return f"{estimate.mean:z.2f} ± {estimate.half:.2f}"


def value_words(estimate: Estimate | None) -> str:
    """A value with half its interval."""
    return NOTHING if estimate is None else estimate.in_words(unknown="")


def interval_words(estimate: Estimate | None) -> str:
    """The ends of an interval."""
    if estimate is None or math.isnan(estimate.half):
        return NOTHING
    return f"{estimate.mean - estimate.half:z.2f} to {estimate.mean + estimate.half:z.2f}"


def number(value: float | None) -> str:
    """A number with two digits."""
    return NOTHING if value is None else f"{value:z.2f}"


def one_card(card: Card) -> list[list[str]]:
    """A line for each row, under heads; the first column, and the last, which says what has no answer, are words."""
    rows = [["row", "score", "95% interval", "n", "value", "random", "best", "of"]]
    for line in card.lines:
        score = NOTHING if line.score is None else number(line.score.mean)
        ends = score, interval_words(line.score), f"{line.n}", value_words(line.value), number(line.random)
        rows.append([row_words(line.row), *ends, number(line.best), line.reason or line.unit])
    return rows


def several_cards(card: Scorecard) -> list[list[str]]:
    """A line for each row and a column for each agent: scores, and values of what has none."""
    rows = [["row", *(each.agent for each in card.cards)]]
    for number_of_row, line in enumerate(card.cards[0].lines):
        rows.append([row_words(line.row), *(_told(each.lines[number_of_row]) for each in card.cards)])
    return rows


def _told(line: Line) -> str:
    return score_words(line.score if line.scored else line.value)


def reasons(cards: Sequence[Card]) -> list[str]:
    """Why there is no answer: a line for each agent and reason, with the rows."""
    found: dict[tuple[str, str], list[str]] = {}
    for card in cards:
        for line in card.lines:
            if line.reason:
                found.setdefault((card.agent, line.reason), []).append(row_words(line.row))
    return [f"{agent}: {why} ({', '.join(rows)})" for (agent, why), rows in found.items()]
