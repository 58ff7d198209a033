"""visitlab: run, record and replay the 'visit the lab' task (Chartouny, Amini, Khamassi and Girard, 2024).

What other people's code may rely on is here, by name: `load` opens a run and `run` makes one; `make_task` makes a task
that is played step by step; `AgentParameters` and
`HumanParameters` are what a kind of theirs derives from, `Setting` where an agent plays, `CHOOSE`, `LEARN`, `REACT` and
`kernel` how a compiled one is registered; the enums say what the numbers of actions, directions and levels mean;
`check_agent` asks of an agent what agents promise. Each is imported when it is asked for.
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

    from visitlab_cli.door import LoadedRun

__version__ = "0.1.0"

_EXPORTS = {
    "AgentParameters": "agents.base",
    "CHOOSE": "agents.base",
    "LEARN": "agents.base",
    "Setting": "agents.base",
    "HumanParameters": "humans.base",
    "REACT": "world.human",
    "kernel": "compiled",
    "Action": "world.enums",
    "Direction": "world.enums",
    "Engagement": "world.enums",
    "InteractionLevel": "world.enums",
    "check_agent": "authoring.check",
    "make_task": "playing",
    "run": "running",
}
"""The module of each name."""
__all__ = ["__version__", "load", *_EXPORTS]


def __getattr__(name: str) -> Any:
    if name not in _EXPORTS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f"{__name__}.{_EXPORTS[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)


def load(run: "str | Path", out: "str | Path" = "runs") -> "LoadedRun":
    """Open a run for Python: `visitlab_cli.load("latest").trials()`; see `visitlab_cli.door.load`."""
    from visitlab_cli.door import load

    return load(run, out)
