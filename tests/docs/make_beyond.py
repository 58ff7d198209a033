"""Write docs/beyond.md and its pictures from finished runs of the configs in configs/beyond.

    python -m tests.docs.make_beyond RUNS      # the folder of runs, with one of each config

Every number is read from the runs, but for the two negative results at the end, which say where they are from.
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.loading import load
from visitlab_cli.figures.doors_figure import bounds, closing_of, recovery
from visitlab_cli.figures.making import make_figures
from visitlab_cli.figures.visits_figure import second_half
from visitlab_cli.paper.figures.source import open_source
from visitlab_cli.replay.strip import strip
from visitlab_cli.results.estimates import mean_of

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images" / "beyond"
TEMPLATE = Path(__file__).with_name("beyond.template.md")
NAMES = ("leading", "labs", "doors", "hidden", "symmetry")
BATCHES = (0, 50, 100, 200, 500, 1000)
FIRST = 20


def sources(runs, names=NAMES):
    """What each run holds, by the config's name; only a finished one of the config as it is."""
    found = {}
    for name in names:
        config = load(shipped_folder() / "beyond" / f"{name}.yaml")
        source = open_source(runs / f"{name}-{config_hash(config)}")
        short = [group.name for group in source.groups.values() if len(group.cells) < group.declared]
        assert not short, f"{name}: not finished: {short}"
        found[name] = source
    return found


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join(f"| {' | '.join(map(str, line))} |" for line in lines)


def group_of(source, experiment, agent=None, human=None):
    (found,) = (
        group
        for group in source.groups.values()
        if group.cells[0].experiment == experiment
        and agent in (None, group.cells[0].agent)
        and human in (None, group.cells[0].human)
    )
    return found


def visits(source, rows, columns):
    """Goals a trial in the second half: rows of (words, what to ask `group_of`), by columns of (words, the same)."""
    told = [
        [words, *(second_half(group_of(source, **asked, **also))[0].in_words() for _, also in columns)]
        for words, asked in rows
    ]
    return table(["", *(words for words, _ in columns)], told)


def level(group, part=100):
    """Reward a trial in the last hundredth of the trials."""
    rewards = group.rewards()
    return mean_of(rewards[:, -max(1, rewards.shape[1] // part) :].mean(axis=1).tolist()).in_words()


def leading(source):
    rows = [
        ("the paper's modules", {"experiment": "paper"}),
        ("`[route, mask]`", {"experiment": "route_mask"}),
        ("`lead`", {"experiment": "lead"}),
        ("`lead`, `told: true`", {"experiment": "lead_told"}),
    ]
    return visits(source, rows, [(f"Human {n}", {"human": f"human_{n}"}) for n in (1, 2, 3)])


def labs(source):
    rows = {"open": "open", "nine": "nine rooms", "corridor": "corridor, eight rooms", "twenty": "twenty rooms"}
    told = [
        [words, *(second_half(group_of(source, f"{lab}_{how}"))[0].in_words() for how in ("paper", "mask", "lead"))]
        for lab, words in rows.items()
    ]
    return table(["", "the paper's modules", "`[route, mask]`", "`lead`"], told)


def doors(source):
    told, exact = [], {}
    for agent in ("mb", "last_seen"):
        group = group_of(source, "navigation_closing", agent)
        values = recovery(group, BATCHES).T
        told.append([agent, *(mean_of(batch[~np.isnan(batch)].tolist()).in_words() for batch in values)])
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
        told.append([experiment, *(mean_of(rewards[:, part].mean(axis=1).tolist()).in_words() for part in parts)])
    return table(["", "before, from trial 20 on", f"first {FIRST} after", "the rest"], told)


def hidden(source):
    told = []
    for how, words in (
        ("full", "engagement observed"),
        ("given", "belief, the true parameters"),
        ("em", "belief, parameters by EM"),
        ("memoryless", "geometry alone"),
    ):
        row = [words]
        for human, suffix in (("human_2", ""), ("human_2_sometimes", "_sometimes")):
            row += [level(group_of(source, f"social_{how}", human=human))]
            row += [second_half(group_of(source, f"{how}{suffix}"))[0].in_words()]
        told.append(row)
    return table(["", "Human 2: social", "visit", "p_P = 0.5: social", "visit"], told)


def symmetry(source):
    found = {
        (group.cells[0].agent, group.cells[0].human): level(group)
        for group in source.groups.values()
        if group.cells[0].task == "social"
    }
    humans = sorted({human for _, human in found})
    agents = list(dict.fromkeys(agent for agent, _ in found))
    return table(["", *humans], [[agent, *(found.get((agent, human), "-") for human in humans)] for agent in agents])


def main():
    found = sources(Path(sys.argv[1]))
    IMAGES.mkdir(parents=True, exist_ok=True)
    for name, only in (("leading", "visits"), ("labs", "visits"), ("doors", "doors"), ("hidden", "visits")):
        (file,) = make_figures(found[name].run, strip, [only], "png", IMAGES / name).files
        file.rename(IMAGES / f"{name}.png")
        file.parent.rmdir()
    closing = closing_of(group_of(found["doors"], "navigation_closing", "mb").cells[0].settings)
    assert closing is not None
    seeds = {name: source.config.seeds for name, source in found.items()}
    text = TEMPLATE.read_text(encoding="utf-8").format(
        leading=leading(found["leading"]),
        labs=labs(found["labs"]),
        doors=doors(found["doors"]),
        closing_visits=closing_visits(found["doors"]),
        hidden=hidden(found["hidden"]),
        symmetry=symmetry(found["symmetry"]),
        seeds=min(seeds.values()),
    )
    (ROOT / "docs" / "beyond.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
