"""The program `visitlab`, and `python -m visitlab_cli`: Ctrl-C ends it in one line from the first moment on."""

import signal

from visitlab_cli.stopping import end_at_once, ending_signals


def main() -> None:
    """Import the command line, which takes a moment, and run it."""
    for number in ending_signals():
        signal.signal(number, end_at_once)
    from visitlab_cli.cli import main as command_line

    command_line()


if __name__ == "__main__":
    main()
