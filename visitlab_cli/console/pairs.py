"""The table of `compare` where conditions are compared two by two: `--by KEY`, or two runs."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from visitlab_cli.console.unread import tell_unread
from visitlab_cli.console.words import aligned
from visitlab_cli.terminal import plain, tell_json, tell_text

if TYPE_CHECKING:
    from visitlab_cli.plan.cells import Cell
    from visitlab_cli.results.pairs import Pair, Side
    from visitlab_cli.results.varying import Varying


MOST_NAMED = 6


def tell_by(folder: Path, key: str, phase: int | None, as_json: bool) -> None:
    """Print all pairs of conditions of a run, or of a phase of it, that differ in `key` alone."""
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.results.pairs import EXPERIMENT, compare_by
    from visitlab_cli.storage.run_folder import read_config

    cells = plan(read_config(folder))
    compared = compare_by(folder, cells, key, phase)
    tell_unread(folder, cells)
    notes = ["By experiment some modules that are the same are enough to be paired."] if key == EXPERIMENT else []
    notes += _left_out(f"nothing differs from it in {key} alone", compared.alone)
    notes += _by_different_code({folder: cells})
    told = {"run": str(folder), "by": key, "phase": phase, "not_compared": compared.alone}
    _tell(told, compared.pairs, notes, as_json)


def _left_out(reason: str, alone: list[str]) -> list[str]:
    from visitlab_cli.wording import few

    return [f"Not compared, {reason}: {few(alone, MOST_NAMED)}."] if alone else []


def _by_different_code(planned: "dict[Path, list[Cell]]") -> list[str]:
    """That what is compared was made by different code, if it was."""
    from visitlab_cli.storage.made_by import made_by, mixed

    found: dict[str, list[str]] = {}
    for run, cells in planned.items():
        for sources, paths in made_by(run, (cell.path for cell in cells)).items():
            found.setdefault(sources, []).extend(f"{run.name}/{path}" for path in paths)
    return [f"Note: {line}" for line in [mixed(found)] if line]


def tell_runs(first: Path, second: Path, as_json: bool) -> None:
    """Print each condition that two runs have in common, and how their configs differ."""
    from visitlab_cli.config.canonical import hashed
    from visitlab_cli.plan.cells import plan
    from visitlab_cli.results.pairs import compare_runs
    from visitlab_cli.storage.differences import differences, in_words
    from visitlab_cli.storage.run_folder import read_config

    configs = [read_config(run) for run in (first, second)]
    ours, theirs = [(run, plan(config)) for run, config in zip((first, second), configs, strict=True)]
    compared = compare_runs(ours, theirs)
    for run, cells in dict([ours, theirs]).items():
        tell_unread(run, cells)
    changes = differences(hashed(configs[0]), hashed(configs[1]))
    told = {"first": str(first), "second": str(second), "config": [each.as_json("first", "second") for each in changes]}
    notes = _left_out("the other run has none of that name", compared.alone)
    notes += [f"in {second.name} {in_words(changes)}"] if changes else []
    notes += _by_different_code(dict([ours, theirs]))
    _tell({**told, "not_compared": compared.alone}, compared.pairs, notes, as_json)


def _tell(told: dict[str, Any], pairs: "list[Pair]", notes: list[str], as_json: bool) -> None:
    if as_json:
        whole = {**told, "confidence": 0.95, "notes": notes, "pairs": [pair.as_json() for pair in pairs]}
        tell_json(whole)
        return
    counted = _counted({pair.part for pair in pairs})
    lines = [
        _table(pairs),
        "",
        f"{counted}; the second less the first with half its 95% interval (Student's t; Welch's, unpaired).",
        "Improves: the probability that a seed of the second is better than one of the first; a tie is half.",
        "Paired: the same modules, or the same random numbers, in both; n pairs. Else n is the smaller number.",
        "What counts is independent: visits of the same trained modules are averaged and count once.",
        *map(plain, notes),
    ]
    tell_text("\n".join(lines))


def _counted(parts: set[str]) -> str:
    """Which trials count in the pairs of a table."""
    from visitlab_cli.results.pairs import LAST_TENTH, WHOLE_PHASE

    if parts == {LAST_TENTH, WHOLE_PHASE}:
        return "Last tenth of trials, of a phase all of them"
    return "All trials of each phase" if parts == {WHOLE_PHASE} else "Last tenth of trials"


WORDS = ("measure", "first", "second", "seeds")
NUMBERS = ("mean", "mean of second", "difference", "n", "improves")


def _table(pairs: "list[Pair]") -> str:
    """A line for each pair; what varies is short, and a column where it is the same in both."""
    from visitlab_cli.results.varying import varying

    columns = varying((pair.same for pair in pairs), taken=("where", *WORDS, *NUMBERS))
    own = varying((("", side.value), *side.point) for pair in pairs for side in (pair.first, pair.second))
    head = ["where", *columns.heads.values(), *WORDS, *NUMBERS]
    rows = [[pair.condition, *columns.values(pair.same), *_row(pair, own)] for pair in pairs]
    return aligned([head, *rows], words=len(head) - len(NUMBERS))


def _row(pair: "Pair", own: "Varying") -> list[str]:
    first, second = (_name(side, own) for side in (pair.first, pair.second))
    return [
        *(pair.measure, first, second, "paired" if pair.paired else "independent"),
        *(f"{side.mean:.2f}" for side in (pair.first, pair.second)),
        pair.difference.in_words("+"),
        str(pair.n),
        f"{pair.probability_of_improvement:.2f}",
    ]


def _name(side: "Side", own: "Varying") -> str:
    """What is compared, with the settings that belong to it; of an entry that varies as a whole what differs."""
    if side.value.startswith("{"):
        return " ".join(own.words((("", side.value), *side.point)))
    return " ".join([side.value, *own.words(side.point)])
