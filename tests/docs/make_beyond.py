"""Write docs/beyond.md and its pictures from finished runs of the configs in configs/beyond.

    python -m tests.docs.make_beyond RUNS      # the folder of runs; a section whose runs are not there stays as it is

Every number is read from the runs, but for the two negative results at the end, which say where they are from.
"""

from itertools import pairwise

import numpy as np

from tests.docs.from_runs import Page, Place, between, group_of, human_called, in_words, main, seeds_of, table, up_to
from tests.docs.worth import honest, worth
from visitlab_cli.figures.doors_figure import bounds, recovery
from visitlab_cli.figures.visits_figure import second_half
from visitlab_cli.results.estimates import difference_of

BATCHES = (0, 50, 100, 200, 500, 1000)
FIRST = 20


def visits(source, rows, columns):
    """Goals a trial in the second half: rows of (words, what to ask `group_of`), by columns of (words, the same)."""
    told = [
        [words, *(second_half(group_of(source, **asked, **also)).value.in_words() for _, also in columns)]
        for words, asked in rows
    ]
    return table(["", *(words for words, _ in columns)], told)


def level(group):
    """Reward a trial in the last hundredth of the trials."""
    return in_words(up_to(group, 1))


def leading(source):
    rows = [
        ("the paper's modules", {"experiment": "paper"}),
        ("`[route, mask]`", {"experiment": "route_mask"}),
        ("`lead`", {"experiment": "lead"}),
        ("`lead`, told the human's `p_S` and `p_A`", {"experiment": "lead_told"}),
    ]
    return visits(source, rows, [(f"Human {n}", {"human": f"human_{n}"}) for n in (1, 2, 3)])


def labs(source):
    rows = {"open": "open", "nine": "nine rooms", "corridor": "corridor, eight rooms", "twenty": "twenty rooms"}
    told = [
        [words, *(second_half(group_of(source, f"{lab}_{how}")).value.in_words() for how in ("paper", "mask", "lead"))]
        for lab, words in rows.items()
    ]
    return table(["", "the paper's modules", "`[route, mask]`", "`lead`"], told)


def doors(source):
    told, exact = [], {}
    for agent in ("mb", "last_seen"):
        group = group_of(source, "navigation_closing", agent)
        values = recovery(group, BATCHES).T
        told.append([agent, *(in_words(batch[~np.isnan(batch)].tolist()) for batch in values)])
        exact |= dict(bounds(source, group))
    told += [[name, *["-"] * (len(BATCHES) - 2), f"{value:.2f} (exact)"] for name, value in exact.items()]
    return table(["", *(f"{low + 1}-{high}" for low, high in pairwise(BATCHES))], told)


def closing_visits(source):
    told = []
    for experiment in ("frozen", "own", "last_seen", "known"):
        group = group_of(source, experiment)
        begins = group.cells[0].settings.phase_trials[0]
        rewards = group.rewards()
        parts = (slice(FIRST, begins), slice(begins, begins + FIRST), slice(begins + FIRST, None))
        told.append([experiment, *(in_words(rewards[:, part].mean(axis=1).tolist()) for part in parts)])
    return table(["", "before, from trial 20 on", f"first {FIRST} after", "the rest"], told)


def hidden(source):
    """The table, and what a belief costs where the human must often be shown the way."""
    told, pointing = [], {}
    for how, words in (
        ("full", "engagement observed"),
        ("given", "belief, the true parameters"),
        ("em", "belief, parameters by EM"),
        ("memoryless", "geometry alone"),
    ):
        row = [words]
        for human, suffix in (("human_2", ""), ("human_2_sometimes", "_sometimes")):
            row += [level(group_of(source, f"social_{how}", human=human))]
            row += [second_half(group_of(source, f"{how}{suffix}")).value.in_words()]
        told.append(row)
        pointing[how] = second_half_of(group_of(source, f"{how}_sometimes"))
    losses = {how: difference_of(pointing["full"], pointing[how]).in_words("+") for how in ("given", "em")}
    return losses | {"table": table(["", "Human 2: social", "visit", "p_P = 0.5: social", "visit"], told)}


def second_half_of(group):
    """Of each seed, goals a trial in the second half."""
    return between(group, group.cells[0].trials // 2 + 1, group.cells[0].trials)


def symmetry(source):
    found = {
        (group.cells[0].agent, group.cells[0].human): level(group)
        for group in source.groups.values()
        if group.cells[0].task == "social"
    }
    humans = sorted({human for _, human in found})
    agents = {"mb": "the paper's agent", "mirror": "`symmetric: true`, `unvisited: zero`"}
    rows = [[words, *(found[agent, human] for human in humans)] for agent, words in agents.items()]
    return table(["", *map(human_called, humans)], rows)


FIGURES = ("leading", "labs", "doors", "hidden")
IDEAS = ("adaptation", "strangers", "friends", "coordination", "planners", "exploration")
PLACES = {
    "seeds": Place((), lambda: seeds_of(FIGURES + IDEAS)),
    "leading": Place(("leading",), leading),
    "labs": Place(("labs",), labs),
    "doors": Place(("doors",), doors),
    "closing_visits": Place(("doors",), closing_visits),
    "hidden": Place(("hidden",), hidden),
    "symmetry": Place(("symmetry",), symmetry),
    "worth": Place(IDEAS, worth),
    "honest": Place(IDEAS, honest),
}
PAGE = Page("beyond", PLACES, FIGURES)

if __name__ == "__main__":
    main(PAGE)
