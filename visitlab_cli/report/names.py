"""How conditions are named on a page: by what differs, with short paths, in lines that break where a reader would."""

import re

from visitlab_cli.report.markup import Html, escape

BREAKS = re.compile(r"(?<=[^\W_]{3}[_./=-])(?=[^\W\d])")
"""In a long name behind a word, before a letter; never inside of a number."""


def breakable(text: str) -> Html:
    """Text whose long names may go on in the next line."""
    return Html("<wbr>".join(map(escape, BREAKS.split(text))))
