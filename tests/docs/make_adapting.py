"""Write docs/adapting.md and its pictures from finished runs of adaptation, strangers and friends of configs/beyond.

python -m tests.docs.make_adapting RUNS      # the folder of runs; a section whose run is not there stays as it is
"""

import numpy as np

from tests.docs.from_runs import Page, Place, between, group_of, in_words, main, seeds_of, table
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
        right += [phase.own.mean() for phase in phases[RETURNS]]
    groups = [group_of(source, way) for way in ("multi", "one_model")]
    several, one = (meetings(group.run, group.cells).rest_again for group in groups)
    return {
        "models": f"{np.mean(models):.1f}",
        "switches": f"{np.mean(switches):.0f}",
        "delay": f"{np.median(delays):.0f}",
        "delay_90": f"{np.percentile(delays, 90):.0f}",
        "first": f"{np.median(firsts):.0f}",
        "right": f"{np.mean(right):.0%}",
        "left": f"{len(left)} of {len(cells)}",
        "left_after": f"{np.median(left):.0f}",
        "gain": mean_of((several - one).tolist()).in_words(),
    }


FIGURES = ("adaptation", "strangers", "friends")
PLACES = {
    "seeds": Place((), lambda: seeds_of(FIGURES)),
    "adaptation": Place(("adaptation",), adaptation),
    "strangers": Place(("strangers",), strangers),
    "friends": Place(("friends",), friends),
    "switching": Place(("friends",), switching),
}
PAGE = Page("adapting", PLACES, FIGURES)

if __name__ == "__main__":
    main(PAGE)
