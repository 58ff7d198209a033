"""The versions that a result was made with."""

import platform
from functools import cache
from importlib.metadata import version

PACKAGES = ("mcap", "numba", "numpy", "protobuf", "pyarrow", "zstandard")


@cache
def versions() -> dict[str, str]:
    """Versions by name: visitlab, Python, and the packages that decide the bytes of a result."""
    from visitlab_cli import __version__

    return {
        "visitlab": __version__,
        "python": platform.python_version(),
        **{name: version(name) for name in PACKAGES},
    }
