"""The sign at the edge that says where an unseen robot is."""

import numpy as np
import pytest

from visitlab_cli.scene.scene import Scene
from visitlab_cli.scene.shapes import Role
from visitlab_cli.scene.trial import Trial, load_trial
from visitlab_cli.scene.view import INSET, view_of


@pytest.fixture(scope="module")
def trial(tiny_run):
    return load_trial(tiny_run / "social" / "mf" / "fast" / "seed-0000" / "steps.mcap", 0)


def moved(trial, where):
    """The trial with the robot `where` from the human in step 0, and beside it ever after."""
    steps = {name: values.copy() for name, values in trial.steps.items()}
    for axis, away in zip(("row", "col"), where, strict=True):
        steps[f"robot_{axis}"] = steps[f"human_{axis}"].astype(np.int16) + 1
        steps[f"robot_{axis}"][0] = int(steps[f"human_{axis}"][0]) + away
    return Trial(*(steps if field == "steps" else getattr(trial, field) for field in trial.__dataclass_fields__))


def sign_of(trial, step):
    return next((shape for shape in Scene(trial).moment(step) if shape.role == Role.AWAY), None)


@pytest.mark.parametrize("where", [(-60, 0), (60, 0), (0, 45), (0, -45), (70, -33), (-41, 52), (90, 90)])
def test_it_lies_on_the_way_to_the_robot_at_the_edge(trial, where):
    trial = moved(trial, where)
    sign = sign_of(trial, 0)
    way = (sign.end - sign.start) / np.linalg.norm(sign.end - sign.start)
    human, robot = trial.places("human")[0], trial.places("robot")[0]
    assert sign.text == f"robot, {max(map(abs, where))} cells away"
    assert np.allclose(way, (robot - human) / np.linalg.norm(robot - human), atol=1e-5)
    along = sign.end - human
    assert abs(float(along[0] * way[1] - along[1] * way[0])) < 1e-3
    assert float(along @ way) > 0
    low, high = np.array(view_of(trial)).T
    to_edge = min((sign.end - low).min(), (high - sign.end).min())
    assert to_edge == pytest.approx(INSET, abs=1e-3)


def test_there_is_none_while_the_robot_is_seen(trial):
    trial = moved(trial, (-60, 0))
    assert [sign_of(trial, step) is None for step in range(3)] == [False, True, True]
