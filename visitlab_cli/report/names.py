"""How conditions are named on a page: by what differs, with short paths, in lines that break where a reader would."""

import re
from collections.abc import Sequence

from visitlab_cli.report.markup import Html, escape
from visitlab_cli.results.groups import Group
from visitlab_cli.results.varying import Varying

BREAKS = re.compile(r"(?<=[^\W_]{3}[_./=-])(?=[^\W\d])")
"""In a long name behind a word, before a letter; never inside of a number."""
BETWEEN = " · "


def breakable(text: str) -> Html:
    """Text whose long names may go on in the next line."""
    return Html("<wbr>".join(map(escape, BREAKS.split(text))))


def names_within(groups: Sequence[Group], varied: Varying) -> list[str]:
    """What tells groups apart: agent, human, settings, as far as they differ, and if need be the experiment."""
    parts = [(group.agent, group.human, BETWEEN.join(varied.words(group.point))) for group in groups]
    differs = [len(set(column)) > 1 for column in zip(*parts, strict=True)]
    names = [
        BETWEEN.join(word for word, wanted in zip(part, differs, strict=True) if word and wanted)
        or BETWEEN.join(filter(None, part))
        for part in parts
    ]
    if len(set(names)) == len(names):
        return names
    return [BETWEEN.join((group.experiment, name)) for group, name in zip(groups, names, strict=True)]
