"""How conditions are named on a page: by what differs, with short paths, in lines that break where a reader would."""

import re
from collections.abc import Iterable, Mapping, Sequence

from visitlab_cli.analysis.summary_groups import Group
from visitlab_cli.report.markup import Html, escape

BREAKS = re.compile(r"(?<=[^\W_]{3}[_./=-])(?=[^\W\d])")
"""In a long name behind a word, before a letter; never inside of a number."""
BETWEEN = " · "


def breakable(text: str) -> Html:
    """Text whose long names may go on in the next line."""
    return Html("<wbr>".join(map(escape, BREAKS.split(text))))


def short_paths(groups: Iterable[Group]) -> dict[str, str]:
    """For each path that varies its shortest end that no other has: `p_A` for `humans.shy.p_A`."""
    paths = list(dict.fromkeys(path for group in groups for path, _ in group.point))
    return {path: _short(path, [other for other in paths if other != path]) for path in paths}


def _short(path: str, others: Sequence[str]) -> str:
    parts = path.split(".")
    ends = (".".join(parts[-length:]) for length in range(1, len(parts)))
    return next((end for end in ends if not any(f".{other}".endswith(f".{end}") for other in others)), path)


def settings_of(group: Group, short: Mapping[str, str]) -> list[str]:
    """The varied settings of a group: ['plan_every=500', 'p_A=0.1']."""
    return [f"{short[path]}={value}" for path, value in group.point]


def names_within(groups: Sequence[Group], short: Mapping[str, str]) -> list[str]:
    """What tells groups apart: agent, human, settings, as far as they differ, and if need be the experiment."""
    parts = [(group.agent, group.human, BETWEEN.join(settings_of(group, short))) for group in groups]
    differs = [len(set(column)) > 1 for column in zip(*parts, strict=True)]
    names = [
        BETWEEN.join(word for word, wanted in zip(part, differs, strict=True) if word and wanted)
        or BETWEEN.join(filter(None, part))
        for part in parts
    ]
    if len(set(names)) == len(names):
        return names
    return [BETWEEN.join((group.experiment, name)) for group, name in zip(groups, names, strict=True)]
