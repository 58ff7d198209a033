"""The versions that a result was made with."""

import platform
from collections.abc import Iterable
from functools import cache
from importlib.metadata import version

from visitlab_cli.plugins import versions_of

PACKAGES = ("mcap", "numba", "numpy", "protobuf", "pyarrow", "zstandard")


def versions(kinds: Iterable[type] = ()) -> dict[str, str]:
    """Versions by name: visitlab, Python, the packages that decide the bytes of a result, whose `kinds` take part."""
    return _own() | versions_of(kinds)


@cache
def _own() -> dict[str, str]:
    from visitlab_cli import __version__

    return {
        "visitlab": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }
