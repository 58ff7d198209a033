"""The table of results: a line for each group of cells, with a picture of its mean and interval."""

import math
from collections.abc import Sequence

from visitlab_cli.report.facts import Facts
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import BETWEEN, breakable
from visitlab_cli.report.sections import section
from visitlab_cli.results.expected import Result
from visitlab_cli.results.summary import LEVEL, Summary
from visitlab_cli.results.varying import Varying, varying

WIDTH, HEIGHT, EDGE = 140, 16, 4
"""Of the picture of an interval, in pixels."""
NOTE = (
    "Mean over n independent seeds of the last tenth of trials, with its 95% interval (Student's t) and their median; "
    f"steps until a hundredth of the trials first has {LEVEL:.0%} of the mean, median over cells."
)
FROZEN = " Frozen, the mean is of all trials."
UNKNOWN = "–"


def results(facts: Facts, title: str) -> Html:
    """The results of a run."""
    lines = [*facts.summaries, *facts.evaluated]
    varied = varying(line.group.point for line in lines)
    heads = ["Agent" + BETWEEN + "human", "Mean", "95% interval", "Median", "n", f"Steps to {LEVEL:.0%}"]
    heads += ["Config expects"] if facts.expected else []
    bodies = []
    for name in dict.fromkeys(_title(line) for line in lines):
        members = [line for line in lines if _title(line) == name]
        title_row = element(
            "tr",
            element(
                "th", breakable(name), element("small", members[0].group.measure), scope="rowgroup", colspan=len(heads)
            ),
            class_="group",
        )
        scale = _scale(members)
        rows = [_row(line, heads, scale, varied, facts.expected.get(line.group.path)) for line in members]
        bodies.append(element("tbody", title_row, *rows))
    table = element(
        "table",
        element("thead", element("tr", *(element("th", text, scope="col") for text in heads))),
        *bodies,
        class_="numbers",
    )
    frozen = FROZEN if any(line.group.evaluation.frozen for line in lines) else ""
    return section("results", title, element("p", NOTE + frozen, class_="note"), table)


def _title(line: Summary) -> str:
    evaluation = line.group.evaluation
    return f"{line.group.experiment}, {evaluation.words}" if evaluation.folder else line.group.experiment


def _row(
    line: Summary,
    heads: Sequence[str],
    scale: tuple[float, float],
    varied: Varying,
    expected: Result | None,
) -> Html:
    group = line.group
    incomplete = line.done < len(group.cells)
    n = f"{line.n}" + (f" ({line.done} of {len(group.cells)} cells)" if incomplete else "")
    steps = UNKNOWN if line.steps_to_level is None else f"{line.steps_to_level:,.0f}"
    cells: list[str] = [
        element("b", _mean(line)),
        _picture(line, scale),
        UNKNOWN if line.median is None else f"{line.median:z.2f}",
        n,
        steps,
    ]
    if len(heads) > 1 + len(cells):
        cells.append(_expectation(expected))
    measured = [element("td", cell, data_label=head) for head, cell in zip(heads[1:], cells, strict=True)]
    return element("tr", _condition(line, varied), *measured)


def _condition(line: Summary, varied: Varying) -> Html:
    """Who was it, and at which varied settings."""
    group = line.group
    who = breakable(BETWEEN.join(filter(None, (group.agent, group.human))))
    settings = [element("span", breakable(each)) for each in varied.words(group.point)]
    return element("th", who, element("small", *settings, class_="settings") if settings else None, scope="row")


def _mean(line: Summary) -> str:
    if line.value is None:
        return "not run yet"
    return line.value.in_words(unknown="")


def _expectation(expected: Result | None) -> str:
    if expected is None or expected.expected is None:
        return UNKNOWN
    wanted = f"{expected.expected:.2f} ± {expected.tolerance or 0:.2f}"
    if expected.value is None:
        return wanted
    verdict = element("b", "missed", class_="missed") if expected.missed else element("b", "met", class_="met")
    got = element("small", f"{expected.value:.2f} {expected.measure}")
    return element("span", f"{wanted} ", verdict, got)


def _scale(lines: Sequence[Summary]) -> tuple[float, float]:
    """The least and the greatest value that the pictures of an experiment show; zero is always among them."""
    ends = [0.0]
    for line in lines:
        if line.value is not None:
            half = 0.0 if math.isnan(line.value.half) else line.value.half
            ends += [line.value.mean - half, line.value.mean + half]
    return min(ends), max(ends)


def _picture(line: Summary, scale: tuple[float, float]) -> Html:
    """The mean as a dot on a line from zero, and its interval as a bar; in words for those who do not see it."""
    if line.value is None:
        return element("span", UNKNOWN)
    low, high = scale
    mean, half = line.value

    def x(value: float) -> str:
        share = (value - low) / (high - low) if high > low else 0.0
        return f"{EDGE + share * (WIDTH - 2 * EDGE):.1f}"

    known = not math.isnan(half)
    middle = HEIGHT // 2
    words = f"{mean - half:z.2f} to {mean + half:z.2f}" if known else "one seed: no interval"
    bar = element("line", x1=x(mean - half), x2=x(mean + half), y1=middle, y2=middle, class_="interval")
    picture = element(
        "svg",
        element("line", x1=EDGE, x2=WIDTH - EDGE, y1=middle, y2=middle, class_="track"),
        bar if known else None,
        element("circle", cx=x(mean), cy=middle, r="3.5", class_="dot"),
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        width=WIDTH,
        height=HEIGHT,
        aria_hidden="true",
    )
    return element("span", picture, element("small", words), class_="estimate")
