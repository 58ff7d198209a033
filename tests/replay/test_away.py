"""The sign at the edge that says where an unseen robot is."""

import numpy as np
import pytest

from visitlab_cli.replay.away import INSET, sign_of
from visitlab_cli.replay.blueprint import view_of
from visitlab_cli.replay.trial import Trial, load_trial


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


@pytest.mark.parametrize("where", [(-60, 0), (60, 0), (0, 45), (0, -45), (70, -33), (-41, 52), (90, 90)])
def test_it_lies_on_the_way_to_the_robot_at_the_edge(trial, where):
    trial = moved(trial, where)
    sign = sign_of(trial, 0)
    human, robot = trial.places("human")[0], trial.places("robot")[0]
    assert sign.cells == max(map(abs, where))
    assert np.allclose(sign.way, (robot - human) / np.linalg.norm(robot - human))
    along = sign.place - human
    assert abs(float(along[0] * sign.way[1] - along[1] * sign.way[0])) < 1e-3
    assert float(along @ sign.way) > 0
    low, high = np.array(view_of(trial)).T
    to_edge = min((sign.place - low).min(), (high - sign.place).min())
    assert to_edge == pytest.approx(INSET, abs=1e-3)


def test_there_is_none_while_the_robot_is_seen(trial):
    trial = moved(trial, (-60, 0))
    assert [sign_of(trial, step) is None for step in range(3)] == [False, True, True]
