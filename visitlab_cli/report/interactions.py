"""The table of interactions: a line for each group, with those of the metrics that tell most of them."""

from visitlab_cli.report.choices import AGENT, HUMAN, Choices
from visitlab_cli.report.facts import Facts
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.report.results_table import condition, title_of
from visitlab_cli.report.sections import section
from visitlab_cli.report.tables import UNKNOWN, Body, Row, table
from visitlab_cli.results.metrics import METRICS, PER_HUNDRED, RATIO, SHARE, STEPS_UNIT, WHOLE, GroupMetrics

SHOWN = {
    "robot_gaze": "Robot faces human",
    "human_gaze": "Human faces robot",
    "steps_until_greeted": "Steps to greeted",
    "steps_until_following": "Steps to following",
    "following": "Follows",
    "too_close": "Too close",
    "attention_lost": "Lost per 100 steps",
    "steps_until_back": "Steps until back",
    "steps_until_goal": "Steps to first goal",
    "path_efficiency": "Path efficiency",
}
"""The head of each metric that is shown."""
PARTS = ("Phase", "Trials")
DIGITS = {SHARE: ".0%", STEPS_UNIT: ".1f", PER_HUNDRED: ".1f", RATIO: ".2f"}
NOTE = (
    "From the logs, means over the independent seeds that have such a step: how much of the time each faces the "
    "other, the human follows, the two are too close; how soon, where at all, the human is greeted, follows, reaches "
    "its first goal, and is back after its attention was lost; its shortest way to a goal over the way that it walked. "
)
MORE = "All metrics, with intervals: "


def interactions(facts: Facts, choices: Choices, title: str) -> Html | None:
    """What the recorded interactions were like; None where there are none."""
    found = facts.metrics
    if not found:
        return None
    shown = {name: head for name, head in SHOWN.items() if any(name in each.values for each in found)}
    phased = any(each.part != WHOLE for each in found)
    heads = [AGENT, HUMAN, *(PARTS if phased else ()), *choices.varied.heads.values(), *shown.values()]
    bodies = []
    for name in dict.fromkeys(title_of(each.group) for each in found):
        members = [each for each in found if title_of(each.group) == name]
        rows = [
            Row(
                choices.add(choices.of(each.group)),
                [*_who(each, choices, facts, phased), *(_cell(each, metric) for metric in shown)],
            )
            for each in members
        ]
        bodies.append(Body(name, members[0].group.cells[0].settings.plays.about, rows))
    note = element("p", NOTE, MORE, element("code", f"visitlab metrics {facts.name}"), class_="note")
    return section("interactions", title, note, table(title, heads, bodies))


def _who(each: GroupMetrics, choices: Choices, facts: Facts, phased: bool) -> list[Html]:
    agent, human, *settings = condition(each.group._replace(human=each.human), choices, facts.hues)
    part = [UNKNOWN if value in (None, "") else str(value) for value in each.part] if phased else []
    return [agent, human, *map(breakable, part), *settings]


def _cell(each: GroupMetrics, metric: str) -> Html:
    if metric not in each.values:
        return Html(UNKNOWN)
    estimate, _ = each.values[metric]
    return Html(f"{estimate.mean:z{DIGITS[METRICS[metric].unit]}}")
