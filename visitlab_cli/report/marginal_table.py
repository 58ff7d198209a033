"""The table of marginal means: what each human, agent and varied value reaches over all the others."""

from visitlab_cli.report.choices import AGENT, EXPERIMENT, HUMAN, TASK, Choices, Of
from visitlab_cli.report.facts import Facts
from visitlab_cli.report.interval import Scale, picture, scale_of
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.report.sections import section
from visitlab_cli.report.tables import Body, Row, agent_named, setting, table
from visitlab_cli.results import marginal
from visitlab_cli.results.marginal import Marginal

HEADS = ("Setting", "Value", AGENT, "Mean", "95% interval", "n", "Conditions")
NOTE = (
    "What one value of a setting reaches, as the mean over all conditions that have it, each of the same weight. n "
    "counts the seeds that have finished all of these; the 95% interval (Student's t) is over them, each with its mean "
    "over the conditions: it says how sure the mean of these conditions is, not how much they differ."
)
ALL = "all"


def marginal_means(facts: Facts, choices: Choices, title: str) -> Html | None:
    """The marginal means of a run; None where no two settings vary."""
    if not facts.marginals:
        return None
    bodies = []
    for experiment in dict.fromkeys(line.experiment for line in facts.marginals):
        lines = [line for line in facts.marginals if line.experiment == experiment]
        scale = scale_of(line.mean for line in lines)
        rows = [Row(choices.add(_of(line)), _cells(line, facts, scale)) for line in lines]
        bodies.append(Body(experiment, lines[0].measure, rows))
    return section("marginal", title, element("p", NOTE, class_="note"), table(title, HEADS, bodies))


def _of(line: Marginal) -> Of:
    head = {marginal.AGENT: AGENT, marginal.HUMAN: HUMAN}.get(line.setting, line.setting)
    of: Of = {TASK: [line.groups[0].cells[0].task], EXPERIMENT: [line.experiment]}
    return of | ({AGENT: [line.agent]} if line.agent else {}) | {head: [line.value]}


def _cells(line: Marginal, facts: Facts, scale: Scale) -> list[Html]:
    hues = facts.hues
    return [
        breakable(line.setting),
        agent_named(line.value, hues) if line.setting == marginal.AGENT else setting(line.value),
        agent_named(line.agent, hues) if line.agent else Html(ALL),
        element("b", "not finished" if line.mean is None else line.mean.in_words(unknown="")),
        picture(line.mean, scale),
        Html(line.n),
        Html(line.conditions),
    ]
