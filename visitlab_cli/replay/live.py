"""A trial in the viewer while it goes on: each step is drawn as it comes, each trial is a recording of its own."""

from contextlib import ExitStack

import rerun as rr

from visitlab_cli.replay.program import LOOPBACK, answers, free_port, started
from visitlab_cli.replay.recording import draw_stage, recording_of
from visitlab_cli.replay.stage import Stage
from visitlab_cli.replay.viewer import check_display, wait_until
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.trial import Trial


class Live:
    """A viewer that is open."""

    def __init__(self, instead: str, *options: str) -> None:
        """Open it, with `options` of its own; where there is no display, the message says what to do `instead`.

        Raises:
            UsageError: there is no display.
            RunError: it does not start.
        """
        if not options:
            check_display(instead)
        self._port = free_port()
        self._open = ExitStack()
        viewer = self._open.enter_context(started("--hide-welcome-screen", "--port", str(self._port), *options))
        self._growing: Growing | None = None
        wait_until(lambda: answers(self._port) or viewer.poll() is not None, "the viewer did not start")

    def show(self, trial: Trial) -> None:
        """Show a trial up to its last step; one of another number is another recording."""
        if self._growing is None or trial.number != self._growing.number:
            self._end()
            recording = recording_of(trial)
            recording.connect_grpc(f"rerun+http://{LOOPBACK}:{self._port}/proxy")
            self._growing = Growing(recording, trial.number)
        self._growing.draw(trial)

    def close(self) -> None:
        """Close it."""
        self._end()
        self._open.close()

    def _end(self) -> None:
        if self._growing is not None:
            self._growing.recording.flush()
            self._growing.recording.disconnect()
            self._growing = None


class Growing:
    """A recording of a trial that goes on: what is new of it is added."""

    def __init__(self, recording: rr.RecordingStream, number: int) -> None:
        """Nothing is in it yet."""
        self.recording, self.number = recording, number
        self._drawn = 0
        self._sent: set[str] = set()

    def draw(self, trial: Trial) -> None:
        """Add the steps that it has not yet."""
        draw_stage(Stage(Scene(trial), self.recording, self._drawn, self._sent), following=True)
        self._drawn = trial.length
