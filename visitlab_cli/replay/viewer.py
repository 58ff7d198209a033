"""A recording shown to a person: in the viewer's window, or served to a browser on this machine."""

import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

from visitlab_cli.errors import RunError, UsageError
from visitlab_cli.replay.program import LOOPBACK, answers, free_port, started

INSTEAD = "use --save FILE.rrd, --web, --png FILE.png --step N or --strip FILE.svg instead"
STARTS_WITHIN = 60.0
"""Seconds: a busy machine takes a while."""


def check_display(instead: str = INSTEAD) -> None:
    """Nothing where a window can be opened; the message says what to do `instead`.

    Raises:
        UsageError: there is no display.
    """
    if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise UsageError(f"no display to open the viewer on; {instead}")


def show(content: bytes) -> None:
    """Show a recording in the viewer, until its window is closed.

    Raises:
        UsageError: there is no display.
        RunError: the viewer failed.
    """
    check_display()
    with recording_file(content) as file, started(str(file), "--port", str(free_port())) as viewer:
        if viewer.wait() != 0:
            raise RunError(f"the viewer could not open a window; {INSTEAD}")


def serve(content: bytes, announce: Callable[[str], None]) -> None:
    """Serve a recording to browsers on this machine, until interrupted; `announce` gets the address.

    Raises:
        RunError: the server failed.
    """
    data_port, page_port = free_port(), free_port()
    ports = "--port", str(data_port), "--web-viewer-port", str(page_port)
    with recording_file(content) as file, started(str(file), "--serve-web", *ports) as server:
        wait_until(lambda: answers(page_port) or server.poll() is not None, "Rerun's web server did not start")
        if server.poll() is None:
            announce(web_address(data_port, page_port))
        if server.wait() != 0:
            raise RunError("Rerun's web server failed; use --save FILE.rrd instead")


def web_address(data_port: int, page_port: int) -> str:
    """The address of the page that shows what is served."""
    data = quote(f"rerun+http://{LOOPBACK}:{data_port}/proxy", safe=":/")
    return f"http://{LOOPBACK}:{page_port}/?url={data}"


@contextmanager
def recording_file(content: bytes) -> Iterator[Path]:
    """The recording as a file, for as long as it is needed."""
    with tempfile.TemporaryDirectory(prefix="visitlab-") as folder:
        file = Path(folder) / "trial.rrd"
        file.write_bytes(content)
        yield file


def wait_until(done: Callable[[], bool], otherwise: str) -> None:
    """Wait for something that takes moments.

    Raises:
        RunError: it took too long; `otherwise` says what did not happen.
    """
    end = time.monotonic() + STARTS_WITHIN
    while not done():
        if time.monotonic() > end:
            raise RunError(f"{otherwise} within {STARTS_WITHIN:.0f} seconds")
        time.sleep(0.05)
