"""Where a scene is built: a Rerun recording, the trial's timeline, and what is drawn on it as whole columns."""

from collections.abc import Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
import rerun as rr

from visitlab_cli.scene.colours import Colour
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Vectors

TIMELINE = "step"


class Line(NamedTuple):
    """A line strip: `points` of shape (points, 2), half its thickness in cells, its colour."""

    points: Vectors
    radius: float
    colour: Colour


class _Rows(NamedTuple):
    """A column from a row on, as Rerun takes it."""

    column: Any
    first: int

    def component_descriptor(self) -> Any:
        return self.column.component_descriptor()

    def as_arrow_array(self) -> Any:
        return self.column.as_arrow_array()[self.first :]


class Stage:
    """A recording of one trial; everything is sent as columns over the timeline `step`, nothing step by step.

    Of a trial that goes on, and was drawn before, only the steps from `first` on are sent, and what is in `sent` is
    not sent again: the entities of which what holds for the whole trial is there.
    """

    def __init__(
        self, scene: Scene, recording: rr.RecordingStream, first: int = 0, sent: set[str] | None = None
    ) -> None:
        """Nothing is drawn yet."""
        self.scene = scene
        self.trial = trial = scene.trial
        self.recording = recording
        self.first = first
        self._sent = set() if sent is None else sent
        self._times = [rr.TimeColumn(TIMELINE, sequence=trial.steps["step"][first:].astype(np.int64))]

    def fixed(self, entity: str, *archetypes: Any) -> None:
        """What holds for the whole trial, all of it that there is of an entity."""
        if entity not in self._sent:
            self._sent.add(entity)
            for archetype in archetypes:
                self.recording.log(entity, archetype, static=True)

    def columns(self, entity: str, columns: Any) -> None:
        """Columns with one row a step, step 0 first."""
        rows: list[Any] = [_Rows(column, self.first) for column in columns]
        self.recording.send_columns(entity, self._times, rows)

    def lines(self, entity: str, steps: Iterable[Sequence[Line]], draw_order: float) -> None:
        """The lines that are seen at each step, maybe none."""
        every = [list(lines) for lines in steps]
        flat = [line for lines in every for line in lines]
        if not flat:
            return
        columns = rr.LineStrips2D.columns(
            strips=[line.points for line in flat],
            radii=[line.radius for line in flat],
            colors=[line.colour for line in flat],
        )
        self.columns(entity, columns.partition([len(lines) for lines in every]))
        self.fixed(entity, rr.LineStrips2D.from_fields(draw_order=draw_order))

    def cells(self, entity: str, classes: Any, draw_order: float, opacity: float = 1.0) -> None:
        """Classes of cells of the annotation context, shape (steps + 1, rows, cols), as coloured squares."""
        count, rows, cols = classes.shape
        form = rr.components.ImageFormat(width=cols, height=rows, color_model="L", channel_datatype="U8")
        flat = classes.astype(np.uint8).reshape(count, -1)
        self.columns(entity, rr.SegmentationImage.columns(buffer=list(flat), format=[form] * count))
        self.fixed(entity, rr.SegmentationImage.from_fields(opacity=opacity, draw_order=draw_order))
