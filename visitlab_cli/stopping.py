"""Being asked to end: by which signals, all treated as Ctrl-C is, and so that it is never lost.

Python drops an exception that is raised in a destructor, or where C code calls back, and the compiler crashes after
one that leaves it midway. So the wish is remembered, and comes again until the exception can be raised and is heard.
"""

import os
import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any, NoReturn

AGAIN_AFTER = 0.005
"""Seconds after which an interruption that was put off or dropped comes again."""
COMPILER = ("numba.", "llvmlite.")
EXIT_CODE = 130

_asked = False
_nothing_to_lose = False


def ending_signals() -> list[signal.Signals]:
    """Ctrl-C, a polite end, and a terminal that is closed; one that the user had ignored, as `nohup` does, stays so."""
    asked = [signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    return [signal.SIGINT, *(number for number in asked if signal.getsignal(number) is not signal.SIG_IGN)]


def end_at_once(*of_signal: int | FrameType | None) -> NoReturn:
    """End the program, saying so; also a signal's handler where there is nothing to be lost."""
    with suppress(OSError):
        os.write(2, b"interrupted\n")
    os._exit(EXIT_CODE)


@contextmanager
def interruptible() -> Iterator[None]:
    """In the block an ending signal raises KeyboardInterrupt, if need be again and again."""
    global _asked
    _asked = False
    before = {number: signal.signal(number, _interrupt) for number in (*ending_signals(), signal.SIGALRM)}
    hook, sys.unraisablehook = sys.unraisablehook, _unraisable
    try:
        yield
    finally:
        sys.unraisablehook = hook
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def nothing_to_lose() -> Iterator[None]:
    """Within `interruptible`: in the block an ending signal ends the program at once, without an exception."""
    global _nothing_to_lose
    _nothing_to_lose = True
    try:
        yield
    finally:
        _nothing_to_lose = False


def was_asked() -> bool:
    """Whether an ending signal came in the block of `interruptible`."""
    return _asked


def check_asked() -> None:
    """End here if that was asked.

    Raises:
        KeyboardInterrupt: it was, and the exception was dropped or mistaken for another.
    """
    if _asked:
        raise KeyboardInterrupt


def _interrupt(number: int, frame: FrameType | None) -> None:
    global _asked
    if _nothing_to_lose:
        end_at_once()
    _asked = True
    if _compiles(frame):
        _come_again()
    else:
        raise KeyboardInterrupt


def _compiles(frame: FrameType | None) -> bool:
    while frame is not None:
        if str(frame.f_globals.get("__name__")).startswith(COMPILER):
            return True
        frame = frame.f_back
    return False


def _unraisable(dropped: Any) -> None:
    if issubclass(dropped.exc_type, KeyboardInterrupt):
        _come_again()
    else:
        sys.__unraisablehook__(dropped)


def _come_again() -> None:
    signal.setitimer(signal.ITIMER_REAL, AGAIN_AFTER)
