"""Rerun's own program: where it is, how it is started on this machine only, how it ends."""

import contextlib
import importlib.util
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import FrameType

from visitlab_cli.errors import Interrupted, RunError
from visitlab_cli.stopping import ending_signals

LOOPBACK = "127.0.0.1"
ENDS_WITHIN = 5.0


def program() -> Path:
    """The viewer that comes with the package rerun-sdk.

    Raises:
        RunError: it is not there.
    """
    package = importlib.util.find_spec("rerun_cli")
    folder = Path(package.origin).parent if package and package.origin else Path()
    bundled = folder / "Rerun.app" / "Contents" / "MacOS" / "Rerun"
    path = bundled if sys.platform == "darwin" and bundled.exists() else folder / "rerun"
    if not path.is_file():
        raise RunError(f"{path}: Rerun's viewer is missing; install rerun-sdk again")
    return path


def free_port() -> int:
    """A port of the loopback interface that nobody listens on."""
    with socket.socket() as listener:
        listener.bind((LOOPBACK, 0))
        port: int = listener.getsockname()[1]
        return port


@contextlib.contextmanager
def started(
    *arguments: str, environment: dict[str, str] | None = None, without: tuple[str, ...] = ()
) -> Iterator[subprocess.Popen[bytes]]:
    """Rerun's program, silent, reachable from this machine only; it ends with the block, and so does what it leaves.

    Args:
        arguments: its options.
        environment: variables for it.
        without: how the names of variables begin that it does not get.
    """
    command = [str(program()), *arguments, "--bind", LOOPBACK]
    for number in ending_signals():
        signal.signal(number, _stop)
    ours = {name: value for name, value in os.environ.items() if not name.startswith(without)}
    with tempfile.TemporaryDirectory(prefix="visitlab-", ignore_cleanup_errors=True) as folder:
        surroundings = {**ours, "TMPDIR": folder, "RERUN_APP_ONLY": "true", **(environment or {})}
        with subprocess.Popen(
            command, env=surroundings, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        ) as process:
            try:
                yield process
            finally:
                process.terminate()
                try:
                    process.wait(ENDS_WITHIN)
                except subprocess.TimeoutExpired:
                    process.kill()


def _stop(number: int, frame: FrameType | None) -> None:
    """A polite end is an end like Ctrl-C's, so that Rerun's program ends too."""
    raise Interrupted("stopped")


def answers(port: int) -> bool:
    """Whether somebody listens on a port of the loopback interface."""
    with socket.socket() as caller:
        caller.settimeout(0.2)
        return caller.connect_ex((LOOPBACK, port)) == 0
