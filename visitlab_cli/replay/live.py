"""A trial in the viewer while it goes on: each step is drawn as it comes, each trial is a recording of its own."""

from contextlib import ExitStack

import rerun as rr

from visitlab_cli.replay.program import LOOPBACK, answers, free_port, started
from visitlab_cli.replay.recording import draw, recording_of
from visitlab_cli.replay.viewer import check_display, wait_until
from visitlab_cli.scene.trial import Trial


class Live:
    """A viewer that is open."""

    def __init__(self, *options: str) -> None:
        """Open it.

        Raises:
            UsageError: there is no display.
            RunError: it does not start.
        """
        if not options:
            check_display()
        self._port = free_port()
        self._open = ExitStack()
        viewer = self._open.enter_context(started("--hide-welcome-screen", "--port", str(self._port), *options))
        self._number: int | None = None
        self._recording: rr.RecordingStream | None = None
        wait_until(lambda: answers(self._port) or viewer.poll() is not None, "the viewer did not start")

    def show(self, trial: Trial) -> None:
        """Show a trial up to its last step; one of another number is another recording."""
        if self._recording is None or trial.number != self._number:
            self._end()
            self._recording, self._number = recording_of(trial), trial.number
            self._recording.connect_grpc(f"rerun+http://{LOOPBACK}:{self._port}/proxy")
        draw(trial, self._recording, following=True)

    def close(self) -> None:
        """Close it."""
        self._end()
        self._open.close()

    def _end(self) -> None:
        if self._recording is not None:
            self._recording.flush()
            self._recording.disconnect()
            self._recording = None
