"""The program `visitlab`, and `python -m visitlab_cli`: Ctrl-C ends it in one line from the first moment on."""

import atexit
import signal

from visitlab_cli.errors import UsageError
from visitlab_cli.stopping import end_at_once, ending_signals
from visitlab_cli.surroundings import shut_out
from visitlab_cli.terminal import end, open_streams


def main() -> None:
    """Import the command line, which takes a moment, and run it."""
    open_streams()
    for number in ending_signals():
        signal.signal(number, end_at_once)
        # what Python's own end takes away is a handler, which this is not; the first registered is the last called
        atexit.register(signal.signal, number, signal.SIG_IGN)
    try:
        shut_out()
    except UsageError as error:
        end(error.exit_code, str(error))
    from visitlab_cli.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
