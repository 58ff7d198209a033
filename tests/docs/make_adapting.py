"""Write docs/adapting.md and its pictures from finished runs of adaptation, strangers and friends of configs/beyond.

python -m tests.docs.make_adapting RUNS      # the folder of runs; a section whose run is not there stays as it is
"""

import numpy as np

from tests.docs.from_runs import Page, Place, between, group_of, human_called, in_words, main, seeds_of, table
from tests.docs.worth import adapted, again
from tests.docs.worth import met as earned
from visitlab_cli.plan.saved import model_of
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.results.own_models import met
from visitlab_cli.results.phases import FIRST, meetings

MEETINGS = slice(1, 4)
RETURNS = slice(4, None)


def adaptation(source):
    ranges = [(1, 10), (11, 50), (51, 200), (201, 300), (901, 1000)]
    words = source.config.figure.words
    rows = [
        [
            words(human),
            words(how),
            *(in_words(between(group_of(source, how, human=human), *each)) for each in ranges),
        ]
        for human in ("human_1", "human_2", "human_2_pointing")
        for how in ("all_counts", "prior_5", "prior_20", "windowed_50", "forgetting_50")
    ]
    return table(["human", "what counts", *(f"{first}-{last}" for first, last in ranges)], rows)


def prices(source):
    """What light old counts and forgetting cost where the past is true."""
    humans = {"same": "human_2", "pointing": "human_2_pointing"}
    light = {name: adapted(source, "prior_20", human) for name, human in humans.items()}
    late = {
        f"{way}_{name}": adapted(source, f"{way}_50", human, (901, 1000))
        for way in ("windowed", "forgetting")
        for name, human in humans.items()
    }
    return light | late


def strangers(source):
    ranges = [(1, 10), (11, 50), (51, 200), (201, 300)]
    visits = [group for group in source.groups.values() if group.cells[0].settings.assembled]
    words = source.config.figure.words
    rows = [
        [
            words(group.cells[0].experiment),
            words(group.cells[0].human),
            *(in_words(between(group, *each)) for each in ranges),
        ]
        for group in visits
    ]
    return table(["trained with", "meets", *(f"{first}-{last}" for first, last in ranges)], rows)


def friends(source):
    visits = [group for group in source.groups.values() if group.cells[0].settings.assembled]
    rows = []
    for group in visits:
        found = meetings(group.run, group.cells)
        means = [in_words(values.tolist()) for values in found[:4]]
        whole = in_words(group.rewards().mean(axis=1).tolist())
        rows.append([source.config.figure.words(group.cells[0].experiment), *means, whole])
    heads = [f"first meeting, {FIRST} trials", "rest", f"return, {FIRST} trials", "rest", "all"]
    return table(["agent", *heads], rows)


def over_long(source):
    """A pool of three over as many steps with Human 2, and over the very human, in words."""
    against = {"long": "from_human_2_long", "itself": "from_itself"}
    return {name: earned(source, "from_1_2_3", way, "human_4") for name, way in against.items()}


def by_human(source):
    """What each way earns on a return over one model, human by human and by seed."""
    words, ways = source.config.figure.words, ("light_counts", "forgetting", "multi", "told", "pooled_one_model")
    met_in = [phase.met for phase in group_of(source, "one_model").cells[0].settings.phases]
    returning = {human: [n for n in range(len(met_in))[RETURNS] if met_in[n] == human] for human in sorted(set(met_in))}

    def rest(way):
        rewards = group_of(source, way).rewards()
        of_phase = rewards.reshape(len(rewards), len(met_in), -1)[:, :, FIRST:].mean(axis=2)
        return np.array([of_phase[:, phases].mean(axis=1) for phases in returning.values()])

    rows = []
    for way in ways:
        told = [mean_of(each.tolist()).in_words("+") for each in rest(way) - rest("one_model")]
        rows.append([words(way), *told, again(source, way)])
    heads = [*map(human_called, returning)]
    return table(["over model_based", *heads, "all"], rows)


def switching(source):
    """What `multi_model` made of it, in words."""
    models, switches, delays, firsts, right, left = [], [], [], [], [], []
    cells = group_of(source, "multi").cells
    for cell in cells:
        saved = model_of(source.run, cell)
        left += [step for step, before, _, since in saved["switches"].tolist() if (before, since) == (0, 0)]
        models.append(len(saved["models_q"]) / len(saved["q"]))
        switches.append(len(saved["switches"]))
        phases = list(met(cell, saved))
        firsts += [phase.delay for phase in phases[MEETINGS]]
        delays += [phase.delay for phase in phases[RETURNS]]
        right.append(np.mean([phase.own.mean() for phase in phases[RETURNS]]))
    share, half = mean_of(right)
    return {
        "models": mean_of(models).in_words(),
        "switches": mean_of(switches).in_words(),
        "delay": f"{np.nanmedian(delays):.0f}",
        "delay_90": f"{np.nanpercentile(delays, 90):.0f}",
        "missed": f"{np.isnan(delays).sum()} of {len(delays)}",
        "first": f"{np.nanmedian(firsts):.0f}",
        "first_missed": f"{np.isnan(firsts).sum()} of {len(firsts)}",
        "right": f"{share:.0%} ± {half:.0%}",
        "left": f"{len(left)} of {len(cells)}",
        "left_after": f"{np.median(left):.0f}",
    }


def earns(source):
    """What ways to keep old friends earn on a return, over one model whose counts go on, in words."""
    from_pool = {way: again(source, way, "pooled_one_model") for way in ("pooled_light_counts", "pooled_multi")}
    return {way: again(source, way) for way in ("multi", "pooled_one_model")} | from_pool


def more(source):
    """What several models earn over one that lets go of old counts, in words."""
    return {way: again(source, "multi", way) for way in ("light_counts", "forgetting")}


FIGURES = ("adaptation", "strangers", "friends")
PLACES = {
    "seeds": Place((), lambda: seeds_of(FIGURES)),
    "adaptation": Place(("adaptation",), adaptation),
    "prices": Place(("adaptation",), prices),
    "strangers": Place(("strangers",), strangers),
    "over_long": Place(("strangers",), over_long),
    "friends": Place(("friends",), friends),
    "switching": Place(("friends",), switching),
    "by_human": Place(("friends",), by_human),
    "earns": Place(("friends",), earns),
    "more": Place(("friends",), more),
}
PAGE = Page("adapting", PLACES, FIGURES)

if __name__ == "__main__":
    main(PAGE)
