"""The signals that ask a program to end, all treated as Ctrl-C is."""

import signal


def ending_signals() -> list[signal.Signals]:
    """Ctrl-C, a polite end, and a terminal that is closed; one that the user had ignored, as `nohup` does, stays so."""
    asked = [signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else [])]
    return [signal.SIGINT, *(number for number in asked if signal.getsignal(number) is not signal.SIG_IGN)]
