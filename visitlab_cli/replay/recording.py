"""A trial as a Rerun recording: the scene its task needs, in the bytes of an .rrd file with the layout in it."""

import rerun as rr

from visitlab_cli.replay import actors, curves, lab
from visitlab_cli.replay.away import draw_signs
from visitlab_cli.replay.blueprint import blueprint_of, view_of
from visitlab_cli.replay.stage import Stage
from visitlab_cli.replay.trial import Trial

APPLICATION = "visitlab"


def record(trial: Trial) -> bytes:
    """The content of an .rrd file: the trial on the timeline `step`, and its blueprint."""
    name = f"{trial.cell}, trial {trial.number}"
    recording = rr.RecordingStream(APPLICATION, recording_id=f"{trial.cell}/trial-{trial.number}")
    stream = rr.binary_stream(recording)
    recording.send_blueprint(blueprint_of(trial))
    recording.send_recording_name(name)
    draw(Stage(trial, recording))
    content = stream.read(flush=True)
    recording.disconnect()
    return content or b""


def draw(stage: Stage) -> None:
    """Everything that the trial's task has."""
    trial = stage.trial
    lab.draw_legend(stage)
    if trial.has_rooms:
        lab.draw_rooms(stage)
    else:
        lab.draw_open_floor(stage, *view_of(trial))
    if trial.has_goal:
        lab.draw_goal(stage)
    if trial.has_human:
        actors.draw_fields(stage)
        actors.draw_human(stage)
    if trial.has_engagement:
        actors.draw_desired_direction(stage)
    actors.draw_robot(stage)
    draw_signs(stage)
    actors.draw_gestures(stage)
    curves.draw_words(stage)
    curves.draw_states(stage)
    curves.draw_curves(stage)
