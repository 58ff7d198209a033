"""Write docs/adapting.md and its pictures from finished runs of adaptation, strangers and friends of configs/beyond.

python -m tests.docs.make_adapting RUNS      # the folder of runs, with one of each config
"""

import sys
from pathlib import Path

import numpy as np

from tests.docs.make_beyond import IMAGES, ROOT, group_of, sources, table
from visitlab_cli.figures.making import make_figures
from visitlab_cli.plan.saved import model_of
from visitlab_cli.replay.strip import strip
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.results.own_models import met

TEMPLATE = Path(__file__).with_name("adapting.template.md")
FIGURES = {"adaptation": "visits", "strangers": "visits", "friends": "phases"}
FIRST = 20
MEETINGS = slice(1, 4)
RETURNS = slice(4, None)


def between(group, first, last):
    """Goals a trial in trials first to last, from 1."""
    return mean_of(group.rewards()[:, first - 1 : last].mean(axis=1).tolist()).in_words()


def adaptation(source):
    ranges = [(1, 10), (11, 50), (51, 200), (201, 300), (901, 1000)]
    rows = [
        [human, how, *(between(group_of(source, how, human=human), *each) for each in ranges)]
        for human in ("human_1", "human_2", "human_2_pointing")
        for how in ("all_counts", "prior_5", "prior_20", "windowed_50", "forgetting_50")
    ]
    return table(["human", "what counts", *(f"{first}-{last}" for first, last in ranges)], rows)


def strangers(source):
    ranges = [(1, 10), (11, 50), (51, 200), (201, 300)]
    ways = {
        "from_human_2": "Human 2, the paper's way",
        "from_human_2_long": "Human 2, 1,500,000 steps",
        "from_itself": "the very human",
        "from_1_2_3": "pool of Human 1, 2, 3",
        "from_1_2_pointing": "pool of Human 1, 2, 2 with pointing",
        "best_paper_controller": "the same pool, `symmetric`, `prior_strength: 20`",
        "best": "the same, and `controller: lead`",
    }
    there = {(group.cells[0].experiment, group.cells[0].human) for group in source.groups.values()}
    rows = [
        [
            words,
            human.replace("human_", "Human "),
            *(between(group_of(source, way, human=human), *each) for each in ranges),
        ]
        for way, words in ways.items()
        for human in ("human_4", "human_3")
        if (way, human) in there
    ]
    return table(["trained with", "meets", *(f"{first}-{last}" for first, last in ranges)], rows)


def by_phase(group):
    """Goals a trial of each seed in a phase's first trials and in the rest: two arrays (seeds, phases)."""
    trials = group.cells[0].settings.phase_trials
    phases = np.split(group.rewards(), np.cumsum(trials)[:-1], axis=1)
    parts = (slice(FIRST), slice(FIRST, None))
    return [np.stack([phase[:, part].mean(axis=1) for phase in phases], axis=1) for part in parts]


def friends(source):
    ways = {
        "one_model": "`model_based`",
        "windowed": "`windowed`, k 50",
        "forgetting": "`forgetting`, k 50",
        "multi": "`multi_model`",
        "told": "`multi_model`, `told: true`",
        "pooled_one_model": "`model_based` from a pool of Human 1, 2, 3",
        "pooled_multi": "`multi_model` from that pool",
    }
    rows = []
    for way, words in ways.items():
        group = group_of(source, way)
        first, rest = by_phase(group)
        told = (first[:, MEETINGS], rest[:, MEETINGS], first[:, RETURNS], rest[:, RETURNS], group.rewards())
        rows.append([words, *(mean_of(each.mean(axis=1).tolist()).in_words() for each in told)])
    heads = [f"first meeting, {FIRST} trials", "rest", f"return, {FIRST} trials", "rest", "all"]
    return table(["agent", *heads], rows)


def switching(source):
    """What `multi_model` made of it, in words."""
    models, switches, delays, firsts, right = [], [], [], [], []
    for cell in group_of(source, "multi").cells:
        saved = model_of(source.run, cell)
        models.append(len(saved["models_q"]) / len(saved["q"]))
        switches.append(len(saved["switches"]))
        phases = list(met(cell, saved))
        firsts += [phase.delay for phase in phases[MEETINGS]]
        delays += [phase.delay for phase in phases[RETURNS]]
        right += [phase.own.mean() for phase in phases[RETURNS]]
    several, one = (by_phase(group_of(source, way))[1][:, RETURNS].mean(axis=1) for way in ("multi", "one_model"))
    return {
        "models": f"{np.mean(models):.1f}",
        "switches": f"{np.mean(switches):.0f}",
        "delay": f"{np.median(delays):.0f}",
        "delay_90": f"{np.percentile(delays, 90):.0f}",
        "first": f"{np.median(firsts):.0f}",
        "right": f"{np.mean(right):.0%}",
        "gain": mean_of((several - one).tolist()).in_words(),
    }


def main():
    found = sources(Path(sys.argv[1]), FIGURES)
    IMAGES.mkdir(parents=True, exist_ok=True)
    for name, only in FIGURES.items():
        (file,) = make_figures(found[name].run, strip, [only], "png", IMAGES / name).files
        file.rename(IMAGES / f"{name}.png")
        file.parent.rmdir()
    text = TEMPLATE.read_text(encoding="utf-8").format(
        seeds=min(source.config.seeds for source in found.values()),
        adaptation=adaptation(found["adaptation"]),
        strangers=strangers(found["strangers"]),
        friends=friends(found["friends"]),
        **switching(found["friends"]),
    )
    (ROOT / "docs" / "adapting.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
