"""Write docs/planning.md and its pictures from finished runs of coordination, planners, exploration, strangers.

python -m tests.docs.make_planning RUNS      # the folder of runs; a section whose run is not there stays as it is
"""

import numpy as np

from tests.docs.from_runs import ROOT, Page, Place, group_of, human_called, in_words, main, seeds_of, table, up_to
from visitlab_cli.affordances.intents import INTENTS
from visitlab_cli.affordances.intents_picture import save_intents
from visitlab_cli.affordances.restricted import MANY, restricted
from visitlab_cli.plan.cells import plan
from visitlab_cli.plan.saved import model_of
from visitlab_cli.plan.selection import Selection
from visitlab_cli.results.costs import microseconds, updates
from visitlab_cli.results.estimates import difference_of, mean_of

ENOUGH, WINDOW = 5, 200
"""A reward a trial, and over how many successive trials it is the mean."""


def last_tenth(group):
    """Of each seed, the reward a trial in the last tenth."""
    return up_to(group, 1, 10)


def costs(group, measure):
    """Of each seed, what a step cost."""
    return [measure(group.run, cell) for cell in group.cells]


def cost_of(group):
    """Values updated, and microseconds of a core, a step."""
    return amount(costs(group, updates), 1), amount(costs(group, microseconds), 2)


def sweeps_of(group):
    """How many sweeps each seed's training made."""
    cells = group.cells
    parameters = cells[0].config.agents[cells[0].agent]
    if parameters.kind == "coordinated":
        return [float(model_of(group.run, cell)["sweeps"][0]) for cell in cells]
    return [cell.steps / parameters.plan_every for cell in cells]


def amount(values, digits):
    """A mean with its interval and so many digits; of what is the same for each seed that alone."""
    mean, half = mean_of(values)
    return f"{mean:,.{digits}f} ± {half:.{digits}f}" if half else f"{mean:,g}"


def coordination(source):
    words = source.config.figure.words
    rows = []
    for agent in ("model_based", "agree", "agree99"):
        group = group_of(source, "social", agent)
        told = [in_words(up_to(group, share)) for share in (0.25, 0.5, 1)]
        told += [in_words(last_tenth(group)), amount(sweeps_of(group), 0), *cost_of(group)]
        rows.append([words(agent), *told])
    heads = ["agent", "at 25%", "at 50%", "at the end", "last tenth", "sweeps", "values updated a step", "µs a step"]
    return table(heads, rows)


def alone(source):
    """The most that Q-learning alone reaches in the last tenth, in any seed."""
    return f"{max(last_tenth(group_of(source, 'social', 'q_learning'))):.2f}"


def planners(source):
    words = source.config.figure.words
    rows = []
    for group in source.groups.values():
        told = [in_words(up_to(group, share)) for share in (0.2, 0.5, 1)]
        rows.append([words(group.cells[0].agent), *told, in_words(last_tenth(group)), *cost_of(group)])
    heads = ["agent", "at 20%", "at 50%", "at the end", "last tenth", "values updated a step", "µs a step"]
    return table(heads, rows)


def better(source):
    """What planners earn over the paper's, in words."""
    group = {agent: group_of(source, "social", agent) for agent in source.config.agents}
    paper = group["every_1000"]
    told = {agent: difference_of(last_tenth(paper), last_tenth(group[agent])).in_words("+") for agent in group}
    early = difference_of(up_to(paper, 0.2), up_to(group["every_100"], 0.2))
    last = difference_of(up_to(paper, 1), up_to(group["every_100"], 1))
    dearer = mean_of(costs(group["every_100"], microseconds)).mean / mean_of(costs(paper, microseconds)).mean
    return told | {"early": early.in_words("+"), "last": last.in_words("+"), "dearer": f"{dearer:.1f}"}


def steps_until(group):
    """Of each seed, thousands of steps until the first `WINDOW` successive trials with `ENOUGH` reward have ended."""
    sums = np.cumsum(np.pad(group.rewards(), ((0, 0), (1, 0))), axis=1)
    enough = sums[:, WINDOW:] - sums[:, :-WINDOW] >= ENOUGH * WINDOW
    assert enough.any(axis=1).all(), f"{group.name}: not all get there"
    return ((enough.argmax(axis=1) + WINDOW) * group.cells[0].settings.trial_steps / 1000).tolist()


def tried_by(group):
    """Of each seed, the share of all pairs that it ever tried."""
    return [float((model_of(group.run, cell)["visits"] > 0).mean()) for cell in group.cells]


def exploration(source):
    words = source.config.figure.words
    rows = []
    for agent in source.config.agents:
        groups = [group_of(source, "social", agent, human) for human in ("human_1", "human_2")]
        told = [each for group in groups for each in (amount(steps_until(group), 1), in_words(up_to(group, 1)))]
        rows.append([words(agent), *told])
    heads = ["", "Human 1: until 5", "at the end", "Human 2: until 5", "at the end"]
    return table(heads, rows)


def sooner(source, agent, against="epsilon"):
    """Thousands of steps until then, against another: with Human 1, with Human 2."""
    told = []
    for human in ("human_1", "human_2"):
        steps = [steps_until(group_of(source, "social", each, human)) for each in (against, agent)]
        mean, half = difference_of(*steps)
        told.append(f"{abs(mean):.0f} ± {half:.0f} {'sooner' if mean < 0 else 'later'}")
    return "; ".join(told)


def found(source):
    groups = [group_of(source, "social", agent, "human_1") for agent in ("epsilon", "optimistic")]
    more = difference_of(*(up_to(group, 1) for group in groups)).in_words()
    return {agent: sooner(source, agent) for agent in source.config.agents} | {"more": more}


def tried(source):
    shares = {
        agent: mean_of(tried_by(group_of(source, "social", agent, "human_1"))) for agent in ("epsilon", "optimistic")
    }
    return {agent: f"{mean:.1%} ± {half:.1%}" for agent, (mean, half) in shares.items()}


def intents(source):
    """Human 2's table, and the reward by the agent's own values; draws the picture of all humans."""
    by_human = intents_by_human(source)
    names = {human: called(source, human) for human in by_human}
    save_intents([*by_human.values()], ROOT / "docs" / "images" / "intents.png", names)
    found = by_human["human_2"]
    rows = []
    for each in found.sets:
        affording = (
            ["-"] * len(INTENTS) if each.threshold is None else [f"{n:,.0f}" for n in each.affording.mean(axis=0)]
        )
        counts = [f"{each.pairs.mean():,.0f}", f"{each.entries.mean():,.0f}"]
        difference = "-" if each is found.whole else found.difference(each).in_words("+")
        name = each.name if each.threshold is None else f"k {each.threshold:g}"
        rows.append([name, *affording, *counts, in_words(each.reward.tolist()), difference])
    heads = ["pairs", *(intent.value for intent in INTENTS), "planned with", "entries a sweep", "reward a trial"]
    return {"table": table([*heads, "difference, by seed"], rows), "own": in_words(found.own.tolist())}


def sure(source):
    """What a k of 0.9 costs, by seed."""
    found = {human: intents_by_human(source)[human] for human in ("human_2", "human_3")}
    return {
        human: each.difference(next(kept for kept in each.sets if kept.threshold == 0.9)).in_words("+")
        for human, each in found.items()
    }


def called(source, human):
    return source.config.figure.names.get(human, human_called(human))


def others(source):
    rows = []
    for human, found in intents_by_human(source).items():
        if human != "human_2":
            whole = found.whole
            half = next(each for each in found.sets if each.threshold == 0.5)
            many = next(each for each in found.sets if each.name == MANY)
            share = [f"{getattr(half, of).mean() / getattr(whole, of).mean():.0%}" for of in ("pairs", "entries")]
            rewards = [in_words(each.reward.tolist()) for each in (whole, half)]
            seldom = f"{many.entries.mean() / whole.entries.mean():.0%}, {found.difference(many).in_words('+')}"
            rows.append([called(source, human), *share, *rewards, found.difference(half).in_words("+"), seldom])
    heads = ["human", "pairs", "entries a sweep", "reward a trial, all pairs", "k 0.5", "difference, by seed"]
    return table([*heads, "tried 3+ times: entries, difference"], rows)


_FOUND = {}


def intents_by_human(source):
    """What planning with these pairs alone reaches, once for all places, for it is played."""
    if source.run not in _FOUND:
        told = restricted(source.run, plan(source.config), Selection(experiment="social", agent="mb"))
        _FOUND[source.run] = {each.human: each for each in told}
    return _FOUND[source.run]


FIGURES = ("coordination", "planners", "exploration")
PLACES = {
    "seeds": Place((), lambda: seeds_of(FIGURES)),
    "coordination": Place(("coordination",), coordination),
    "alone": Place(("coordination",), alone),
    "planners": Place(("planners",), planners),
    "better": Place(("planners",), better),
    "exploration": Place(("exploration",), exploration),
    "found": Place(("exploration",), found),
    "tried": Place(("exploration",), tried),
    "intents": Place(("strangers",), intents),
    "others": Place(("strangers",), others),
    "sure": Place(("strangers",), sure),
}
PAGE = Page("planning", PLACES, FIGURES)

if __name__ == "__main__":
    main(PAGE)
