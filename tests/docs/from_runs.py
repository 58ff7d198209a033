"""Pages whose numbers are read from finished runs of configs/beyond: a template, and what stands in its places.

A section (from one `## ` to the next) whose runs are not given stays as it is on the page.
"""

import re
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.config.canonical import config_hash
from visitlab_cli.config.files import shipped_folder
from visitlab_cli.config.loading import load
from visitlab_cli.figures.making import make_figures
from visitlab_cli.paper.figures.source import Source, open_source
from visitlab_cli.replay.strip import strip
from visitlab_cli.results.estimates import mean_of
from visitlab_cli.storage.run_folder import is_run

ROOT = Path(__file__).parents[2]
IMAGES = ROOT / "docs" / "images" / "beyond"
SECTION = re.compile(r"^(?=## )", re.MULTILINE)
PLACE = re.compile(r"(?<!\{)\{(\w+)")


class Place(NamedTuple):
    """What stands in a place of a template, made of the runs of these configs."""

    runs: tuple[str, ...]
    make: Callable[..., Any]


@dataclass(frozen=True)
class Page:
    """A page: its name in docs, its places by name, and the configs whose figures it shows."""

    name: str
    places: dict[str, Place]
    figures: tuple[str, ...]

    @property
    def runs(self) -> list[str]:
        """The configs that it is made of."""
        return list(dict.fromkeys(name for place in self.places.values() for name in place.runs))


def source_of(runs: Path, name: str) -> Source | None:
    """The run of a config as it is shipped; None where there is none."""
    config = load(shipped_folder() / "beyond" / f"{name}.yaml")
    run = runs / f"{name}-{config_hash(config)}"
    if not is_run(run):
        return None
    source = open_source(run)
    short = [group.name for group in source.groups.values() if len(group.cells) < config.seeds]
    assert source.groups, f"{name}: nothing is finished"
    assert not short, f"{name}: not finished: {short}"
    assert source.config.figure == config.figure, f"{name}: run it again, for the words of its figure are others"
    return source


def filled(template: str, old: str, places: dict[str, Place], sources: dict[str, Source]) -> tuple[str, list[str]]:
    """The page, and the headings of the sections that stay as they were.

    Args:
        template: the page with its places.
        old: the page as it is.
        places: what stands in each place.
        sources: the runs there are, by the names of their configs.
    """
    before = {section.partition("\n")[0]: section for section in SECTION.split(old)}
    parts, kept = [], []
    for section in SECTION.split(template):
        heading = section.partition("\n")[0]
        names = set(PLACE.findall(section.replace("{{", "")))
        needed = {run for name in names for run in places[name].runs}
        if needed <= sources.keys():
            values = {name: places[name].make(*(sources[run] for run in places[name].runs)) for name in names}
            parts.append(section.format(**values))
        else:
            assert heading in before, f"{heading}: needs runs of {', '.join(sorted(needed - sources.keys()))}"
            parts.append(before[heading].rstrip("\n") + "\n" * (len(section) - len(section.rstrip("\n"))))
            kept.append(heading)
    return "".join(parts), kept


def write(page: Page, runs: Path) -> None:
    """Write a page, and the pictures of those of its runs that there are."""
    sources = {name: source for name in page.runs if (source := source_of(runs, name)) is not None}
    for name in page.figures:
        if name in sources:
            draw(sources[name], name)
    template = Path(__file__).with_name(f"{page.name}.template.md").read_text(encoding="utf-8")
    target = ROOT / "docs" / f"{page.name}.md"
    old = target.read_text(encoding="utf-8") if target.is_file() else ""
    text, kept = filled(template, old, page.places, sources)
    target.write_text(text, encoding="utf-8")
    for heading in kept:
        print(f"{page.name}: {heading}: as it was, for its runs are not here")


def draw(source: Source, name: str) -> None:
    """The figure that a config declares, as a picture of the docs."""
    IMAGES.mkdir(parents=True, exist_ok=True)
    (file,) = make_figures(source.run, strip, [], "png", IMAGES / name).files
    file.rename(IMAGES / f"{name}.png")
    file.parent.rmdir()


def main(page: Page) -> None:
    write(page, Path(sys.argv[1]))


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


def seeds_of(names):
    """How many seeds the configs have, the fewest."""
    return min(load(shipped_folder() / "beyond" / f"{name}.yaml").seeds for name in names)


def between(group, first, last):
    """Of each seed, the reward (in a visit goals) a trial in trials first to last, from 1."""
    return group.rewards()[:, first - 1 : last].mean(axis=1).tolist()


def up_to(group, share, part=100):
    """Of each seed, the reward a trial in the hundredth of the trials that ends at this share of them."""
    trials = group.cells[0].trials
    end = round(share * trials)
    return between(group, end - trials // part + 1, end)


def in_words(values):
    return mean_of(values).in_words()


def human_called(name):
    """What the pages call a human of the configs."""
    return name.replace("human_", "Human ").replace("_", " with ")
