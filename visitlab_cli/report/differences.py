"""The agents two by two: which leads better, by how much, and how sure that is; the script first."""

from collections.abc import Mapping

from visitlab_cli.report.choices import AGENT, HUMAN, Choices, Of
from visitlab_cli.report.facts import Facts, counted
from visitlab_cli.report.interval import Scale, picture, scale_of
from visitlab_cli.report.markup import Html, element
from visitlab_cli.report.names import breakable
from visitlab_cli.report.sections import section
from visitlab_cli.report.tables import Body, Row, agent_named, setting, table
from visitlab_cli.results.against_script import AgainstScript
from visitlab_cli.results.pairs import Pair
from visitlab_cli.results.varying import NOTHING

MOST_PAIRS = 200
AGENTS = "Agents"
NOTE = (
    "Last tenth of trials, one agent less the other, with half its 95% interval (Student's t; Welch's where seeds are "
    "independent). Improves: the probability that a seed of the one is better than one of the other; a tie is half."
)
SCRIPT_NOTE = (
    "Last tenth of trials, what was learned less the script, which is told the rules, in the same task with the same "
    "human and settings: the mean of the differences seed by seed, with half its 95% interval (Student's t over n "
    "seeds). Above zero, what was learned is better."
)


def against_script(facts: Facts, choices: Choices, title: str) -> Html | None:
    """A line for each condition that a script can be compared with; None where there is none."""
    found = facts.against_script
    if not found:
        return None
    heads = (AGENT, HUMAN, *choices.varied.heads.values(), "Less", "Difference", "95% interval", "n")
    bodies = []
    for name in dict.fromkeys(each.group.experiment for each in found):
        members = [each for each in found if each.group.experiment == name]
        scale = scale_of(each.difference for each in members)
        rows = [Row(choices.add(choices.of(each.group)), _of_script(each, facts, choices, scale)) for each in members]
        bodies.append(Body(name, members[0].group.measure, rows))
    return section("script", title, element("p", SCRIPT_NOTE, class_="note"), table(title, heads, bodies))


def _of_script(each: AgainstScript, facts: Facts, choices: Choices, scale: Scale) -> list[Html]:
    group, script, hues = each.group, each.script, facts.hues
    theirs = choices.settings(script)
    own = [f"{head}={value}" for head, value in theirs.items() if value not in (NOTHING, choices.settings(group)[head])]
    words = [script.agent if script.experiment == group.experiment else f"{script.experiment}/{script.agent}", *own]
    return [
        agent_named(group.agent, hues),
        setting(group.human),
        *map(setting, choices.settings(group).values()),
        agent_named(script.agent, hues, " ".join(words)),
        element("b", each.difference.in_words("+", unknown="")),
        picture(each.difference, scale),
        Html(each.n),
    ]


def differences(facts: Facts, choices: Choices, title: str) -> Html | None:
    """A line for each two other agents that differ in nothing else; None where there are none."""
    pairs = two_learners(facts)
    if not pairs:
        return None
    shown, more = pairs[:MOST_PAIRS], len(pairs) - MOST_PAIRS
    heads = (AGENTS, HUMAN, *choices.varied.heads.values(), "Difference", "95% interval", "n", "Improves")
    bodies = []
    for where in dict.fromkeys(map(_experiments, shown)):
        members = [pair for pair in shown if _experiments(pair) == where]
        scale = scale_of(pair.difference for pair in members)
        rows = [Row(choices.add(_of(pair, choices)), _of_pair(pair, choices, scale)) for pair in members]
        bodies.append(Body(where, members[0].measure, rows))
    rest = f"{counted(more, 'pair')} more: visitlab compare {facts.name} --by agent"
    left_out = element("p", rest, class_="note") if more > 0 else None
    return section("differences", title, element("p", NOTE, class_="note"), table(title, heads, bodies), left_out)


def two_learners(facts: Facts) -> list[Pair]:
    """The pairs without a script that has lines of its own, where it is compared seed by seed."""
    told = {each.script.agent for each in facts.against_script}
    return [pair for pair in facts.pairs if told.isdisjoint(group.agent for group in pair.groups)]


def _experiments(pair: Pair) -> str:
    return "/".join(dict.fromkeys(group.experiment for group in pair.groups))


def _of(pair: Pair, choices: Choices) -> Of:
    """A pair is of whatever one of the two is of."""
    first, second = map(choices.of, pair.groups)
    return {head: list(dict.fromkeys((*first.get(head, ()), *second.get(head, ())))) for head in choices.heads}


def _of_pair(pair: Pair, choices: Choices, scale: Scale) -> list[Html]:
    first, second = pair.groups
    theirs = choices.settings(second)
    same = [value if theirs[head] == value else "" for head, value in choices.settings(first).items()]
    return [
        _words(f"{pair.second.name} less {pair.first.name}", choices.varied.heads),
        setting(first.human if first.human == second.human else ""),
        *map(setting, same),
        element("b", pair.difference.in_words("+", unknown="")),
        picture(pair.difference, scale),
        Html(f"{pair.n} {'paired' if pair.paired else 'independent'}"),
        Html(f"{pair.probability_of_improvement:.2f}"),
    ]


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
