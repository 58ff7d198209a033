"""What each idea of the paper's discussion is worth on this task, one row each: for docs/beyond.md."""

from tests.docs.from_runs import between, group_of, table
from tests.docs.make_planning import costs, intents_by_human, last_tenth, sooner, sweeps_of
from visitlab_cli.results.costs import microseconds
from visitlab_cli.results.estimates import difference_of, mean_of
from visitlab_cli.results.phases import meetings

ADAPTING, PLANNING = "[adapting](adapting.md)", "[planning](planning.md)"
EARLY = (51, 200)
"""Trials in which adapting is judged."""


def gain(before, after, words="+"):
    """How much more the second reaches than the first, seeds of different trainings being independent."""
    return difference_of(before, after).in_words(words)


def again(source, way, against="one_model"):
    """What a way earns over another on a return, after its first trials: paired, for a seed has the same modules."""
    groups = [group_of(source, each) for each in (against, way)]
    before, after = (meetings(group.run, group.cells).rest_again for group in groups)
    return mean_of((after - before).tolist()).in_words("+")


def adapted(source, way, human, trials=EARLY):
    return gain(*(between(group_of(source, each, human=human), *trials) for each in ("all_counts", way)))


def met(source, way, against, human):
    return gain(*(between(group_of(source, each, human=human), *EARLY) for each in (against, way)))


def ended(source, agent, against):
    """The last tenth of the social task with Human 1 against another agent's."""
    return gain(*(last_tenth(group_of(source, "social", each, "human_1")) for each in (against, agent)))


def dearer(source, agent, against="every_1000"):
    """How many times the core's time of another agent."""
    means = [mean_of(costs(group_of(source, "social", each), microseconds)).mean for each in (agent, against)]
    return f"{means[0] / means[1]:.1f}"


def adapting(adaptation, strangers, friends):
    """Rows of (idea, over what, goals a trial, verdict)."""
    light, four = "prior_20", "human_4"
    pointing, late = "human_2_pointing", (901, 1000)
    yield (
        "**general model**: pool of Human 1, 2, 3 (`prior_strength: 20`), stranger",
        "trained with Human 2",
        met(strangers, "from_1_2_3", "from_human_2", four),
        "**learning earns most here**",
    )
    yield (
        "pool of Human 1, 2, 2 with pointing, a stranger who is hard to lead (Human 3)",
        "trained with Human 2",
        met(strangers, "from_1_2_pointing", "from_human_2", "human_3"),
        "holds for who is unlike them, too",
    )
    yield (
        "Human 2 alone, as many steps as the three; with Human 3",
        "500,000 steps",
        "; ".join(met(strangers, "from_human_2_long", "from_human_2", human) for human in (four, "human_3")),
        "so some of it is training; the rest is variety",
    )
    yield (
        "**light old counts** (`prior_strength: 20`), Human 1 after Human 2",
        "all counts",
        adapted(adaptation, light, "human_1"),
        "**the cheapest gain**",
    )
    yield (
        "the same, Human 2 goes on; needs pointing",
        "all counts",
        f"{adapted(adaptation, light, 'human_2')}; {adapted(adaptation, light, pointing)}",
        "the second is its price; it takes every visit's human for a new one",
    )
    yield (
        "`windowed`; `forgetting` (k 50), Human 1 after Human 2",
        "all counts",
        "; ".join(adapted(adaptation, way, "human_1") for way in ("windowed_50", "forgetting_50")),
        "nearly as good",
    )
    yield (
        "the same, Human 2 goes on, trials 901-1000",
        "all counts",
        "; ".join(adapted(adaptation, way, "human_2", late) for way in ("windowed_50", "forgetting_50")),
        "what is true is forgotten, too: a loss is shown of the first",
    )
    yield (
        "**a model for each human** (`multi_model`), old friends return",
        "one model",
        again(friends, "multi"),
        "all of it with Human 1; that it is more than the next is not shown",
    )
    yield (
        "light old counts (`prior_strength: 20`); `forgetting` (k 50), old friends return",
        "one model",
        "; ".join(again(friends, way) for way in ("light_counts", "forgetting")),
        "without several models",
    )
    yield (
        "a general model (pool of Human 1, 2, 3), old friends return",
        "one model",
        again(friends, "pooled_one_model"),
        "**the most**, for three trainings instead of one",
    )
    yield (
        "from there, `multi_model`; a lighter pool (20 visits to a pair instead of 300)",
        "one model",
        "; ".join(again(friends, way, "pooled_one_model") for way in ("pooled_multi", "pooled_light_counts")),
        "nothing: the general model has it already",
    )
    yield (
        "being told who comes (`told: true` of `multi_model`)",
        "finding out",
        again(friends, "told", "multi"),
        "finding out is not what limits",
    )
    yield (
        "all together: pool, `symmetric`, light counts, `controller: lead`",
        "the paper's robot",
        met(strangers, "best", "from_human_2", four),
        f"of it by [leading](leading.md) {met(strangers, 'best', 'best_paper_controller', four)}",
    )


def planning(strangers, coordination, planners, exploration):
    """The same, of reward a trial or thousands of steps."""
    share = mean_of(sweeps_of(group_of(coordination, "social", "agree"))).mean / 1000
    yield (
        "**arbitration** of two experts (`coordinated`, 0.9)",
        "model-based",
        ended(coordination, "agree", "model_based"),
        f"no loss shown with {share:.0%} of the sweeps",
    )
    for words, agent in (
        ("a sweep every 100 steps", "every_100"),
        ("prioritized sweeping, 5 states", "prioritized_5"),
        ("Dyna, expected, 10 pairs", "dyna_expected"),
        ("Dyna, sampled, 10 pairs", "dyna_sampled"),
    ):
        verdict = "a loss" if agent == "dyna_sampled" else "no gain shown"
        told = f"{verdict}, at {dearer(planners, agent)} times the core's time"
        yield words, "a sweep every 1000", ended(planners, agent, "every_1000"), told
    afforded = intents_by_human(strangers)["human_2"]
    half = next(each for each in afforded.sets if each.threshold == 0.5)
    entries = half.entries.mean() / afforded.whole.entries.mean()
    yield (
        "planning with what affords an intent (k 0.5), Human 2",
        "all pairs tried",
        afforded.difference(half).in_words("+"),
        f"a small loss with {entries:.0%} of a sweep's entries",
    )
    last = ended(exploration, "optimistic", "epsilon")
    yield "**symmetry**, by chance", "by chance", sooner(exploration, "epsilon_mirror"), "**finds the chain sooner**"
    yield (
        "optimism",
        "by chance",
        sooner(exploration, "optimistic"),
        f"one way and the other; {last} reward in the last tenth with Human 1",
    )
    yield "a count bonus, 0.3", "by chance", sooner(exploration, "bonus_03"), "no help"
    yield (
        "optimism and symmetry",
        "symmetry",
        sooner(exploration, "optimistic_mirror", "epsilon_mirror"),
        "pays where little is left to try",
    )


def worth(adaptation, strangers, friends, coordination, planners, exploration):
    """The table."""
    rows = [(*row, ADAPTING) for row in adapting(adaptation, strangers, friends)]
    rows += [(*row, PLANNING) for row in planning(strangers, coordination, planners, exploration)]
    return table(["idea", "over", "earns", "in plain words", "more"], rows)


def honest(adaptation, strangers, friends, coordination, planners, exploration):
    """The negative results in two lines."""
    pooled, told = again(friends, "pooled_multi", "pooled_one_model"), again(friends, "told", "multi")
    three = (ended(planners, agent, "every_1000") for agent in ("every_100", "prioritized_5", "dyna_expected"))
    return (
        f"- *Knowing who is there*, where there is a general model: {pooled} goals over one model; being told, "
        f"where there is none, {told} over finding out.\n"
        f"- *Better planners* (every 100 steps, prioritized, Dyna): {', '.join(three)} reward in the last tenth."
    )
