"""visitlab: run, record and replay the 'visit the lab' task (Chartouny, Amini, Khamassi and Girard, 2024)."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from visitlab_cli.door import LoadedRun

__version__ = "0.1.0"


def load(run: "str | Path", out: "str | Path" = "runs") -> "LoadedRun":
    """Open a run for Python: `visitlab_cli.load("latest").trials()`; see `visitlab_cli.door.load`."""
    from visitlab_cli.door import load

    return load(run, out)
