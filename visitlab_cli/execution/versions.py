"""The versions that a result was made with, and all else that decides its bytes."""

import platform
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version
from typing import Any

from visitlab_cli.plan.cells import Cell
from visitlab_cli.plugins import versions_of
from visitlab_cli.sources import sources
from visitlab_cli.storage.facts import SOURCES

PACKAGES = ("mcap", "numba", "numpy", "protobuf", "pyarrow", "zstandard")


def versions(kinds: Iterable[type] = ()) -> dict[str, str]:
    """Versions by name: visitlab, Python, the packages that decide the bytes of a result, whose `kinds` take part."""
    return _own() | versions_of(kinds)


def decided_by(cell: Cell) -> dict[str, Any]:
    """What decides the bytes of a cell, as `cell.json` and checkpoints say it: its name, config, versions and code."""
    kinds = cell.config.kinds
    return {
        "cell": cell.path,
        "config_hash": cell.run_hash,
        "versions": versions(kinds),
        SOURCES: sources(kinds),
    }


@cache
def _own() -> dict[str, str]:
    from visitlab_cli import __version__

    return {
        "visitlab": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }
