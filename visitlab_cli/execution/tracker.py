"""Python's tracker of shared resources, which cleans up after a program that was killed; and if it is killed itself.

A tracker that was started anew knows nothing of what there was before; told that such a thing is gone, it writes a
traceback between the lines of the run. So it is told only of what it knows.
"""

from collections.abc import Sized
from multiprocessing import resource_tracker
from typing import Any

_tracker: Any = resource_tracker._resource_tracker
_known: set[tuple[Sized, str]] = set()
_process: int | None = None
_register, _unregister = resource_tracker.register, resource_tracker.unregister


def survive() -> None:
    """Have this process speak to a tracker only of what that one knows."""
    resource_tracker.register, resource_tracker.unregister = _note, _forget


def _note(name: Sized, rtype: str) -> None:
    _look()
    _register(name, rtype)
    _known.add((name, rtype))


def _forget(name: Sized, rtype: str) -> None:
    _look()
    if (name, rtype) in _known:
        _known.discard((name, rtype))
        _unregister(name, rtype)


def _look() -> None:
    """Whether the tracker is another one now, started anew if need be."""
    global _process
    _tracker.ensure_running()
    if _tracker._pid != _process:
        _known.clear()
        _process = _tracker._pid
