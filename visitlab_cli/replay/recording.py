"""A trial as a Rerun recording: the scene its task needs, in the bytes of an .rrd file with the layout in it."""

import rerun as rr

from visitlab_cli.origin import NAME
from visitlab_cli.replay import curves
from visitlab_cli.replay.blueprint import blueprint_of
from visitlab_cli.replay.drawing import draw_scene
from visitlab_cli.replay.stage import Stage
from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.trial import Trial


def record(trial: Trial) -> bytes:
    """The content of an .rrd file: the trial on the timeline `step`, and its blueprint."""
    recording = recording_of(trial)
    stream = rr.binary_stream(recording)
    draw_stage(Stage(Scene(trial), recording), following=False)
    content = stream.read(flush=True)
    recording.disconnect()
    return content or b""


def recording_of(trial: Trial) -> rr.RecordingStream:
    """A recording for a trial, still empty and going nowhere."""
    return rr.RecordingStream(NAME, recording_id=f"{trial.cell}/trial-{trial.number}")


def draw_stage(stage: Stage, *, following: bool) -> None:
    """Draw what the stage is to send; `following` where the viewer is to show the last step that there is."""
    trial = stage.trial
    stage.recording.send_blueprint(blueprint_of(stage.scene, following=following))
    stage.recording.send_recording_name(trial.name)
    draw_scene(stage)
    curves.draw_words(stage)
    curves.draw_states(stage)
    curves.draw_curves(stage)
    curves.draw_belief(stage)
