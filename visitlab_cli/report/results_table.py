"""The table of results: a line for each group of cells, with a picture of its mean and interval."""

from collections.abc import Mapping, Sequence

from visitlab_cli.report.choices import AGENT, HUMAN, Choices
from visitlab_cli.report.facts import Facts
from visitlab_cli.report.interval import Scale, picture, scale_of
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.sections import section
from visitlab_cli.report.tables import UNKNOWN, Body, Row, agent_named, setting, table
from visitlab_cli.results.expected import Result
from visitlab_cli.results.groups import Group
from visitlab_cli.results.summary import LEVEL, Summary
from visitlab_cli.results.units import SHARED

NOTE = (
    "Mean over n independent seeds of the last tenth of trials, with its 95% interval (Student's t) and their median; "
    f"steps until a hundredth of the trials first has {LEVEL:.0%} of the mean, median over cells."
)
FROZEN = "Frozen, the mean is of all trials."
MEASURED = ("Mean", "95% interval", "Median", "n", f"Steps to {LEVEL:.0%}")
EXPECTS = "Config expects"


def results(facts: Facts, choices: Choices, title: str) -> Html:
    """The results of a run."""
    lines = facts.lines
    heads = [AGENT, HUMAN, *choices.varied.heads.values(), *MEASURED, *([EXPECTS] if facts.expected else [])]
    bodies = []
    for name in dict.fromkeys(title_of(line.group) for line in lines):
        members = [(number, line) for number, line in enumerate(lines) if title_of(line.group) == name]
        scale = scale_of(line.value for _, line in members)
        rows = [Row(number, _cells(line, choices, facts, scale)) for number, line in members]
        bodies.append(Body(name, members[0][1].group.measure, rows))
    frozen = FROZEN if any(line.group.evaluation.frozen for line in lines) else None
    shared = SHARED if any(line.units.shared for line in lines) else None
    note = element("p", " ".join(filter(None, (NOTE, frozen, shared))), class_="note")
    return section("results", title, note, table(title, heads, bodies))


def _cells(line: Summary, choices: Choices, facts: Facts, scale: Scale) -> list[Html]:
    group = line.group
    n = f"{line.n}" + (f" ({line.done} of {len(group.cells)} cells)" if line.done < len(group.cells) else "")
    measured: list[str] = [
        UNKNOWN if line.median is None else f"{line.median:z.2f}",
        n,
        UNKNOWN if line.steps_to_level is None else f"{line.steps_to_level:,.0f}",
    ]
    return [
        *condition(line.group, choices, facts.hues),
        element("b", "not run yet" if line.value is None else line.value.in_words(unknown="")),
        picture(line.value, scale),
        *map(Html, measured),
        *([_expectation(facts.expected.get(group.path))] if facts.expected else []),
    ]


def title_of(group: Group) -> str:
    """Under which title a group's line stands."""
    evaluation = group.evaluation
    return f"{group.experiment}, {evaluation.words}" if evaluation.folder else group.experiment


def condition(group: Group, choices: Choices, hues: Mapping[str, int]) -> Sequence[Html]:
    """Who was it, with whom, and at which varied settings."""
    settings = map(setting, choices.settings(group).values())
    return [agent_named(group.agent, hues), setting(group.human), *settings]


def _expectation(expected: Result | None) -> Html:
    if expected is None or expected.expected is None:
        return Html(UNKNOWN)
    wanted = f"{expected.expected:.2f} ± {expected.tolerance or 0:.2f}"
    if expected.value is None:
        return Html(wanted)
    verdict = element("b", "missed", class_="missed") if expected.missed else element("b", "met", class_="met")
    got = element("small", f"{expected.value:.2f} {expected.measure}")
    return element("span", f"{wanted} ", verdict, got)
