"""What the tests of scene and replay share: trials of each task from the tiny run."""

import pytest

from visitlab_cli.plan.selection import Selection
from visitlab_cli.replay.choice import find_logs
from visitlab_cli.scene.trial import load_trial

CELLS = {
    "navigation": Selection(experiment="navigation", agent="rmax"),
    "go_to_human": Selection(experiment="go_to_human", agent="mb"),
    "social": Selection(experiment="social", agent="script"),
    "visit": Selection(experiment="visit_scripted"),
}


@pytest.fixture(scope="session")
def trial_of(tiny_run):
    """A function: the trial `number` of a task's cell."""

    def load(task, number=1):
        return load_trial(find_logs(str(tiny_run), tiny_run.parent, CELLS[task]).first[0].path, number)

    return load
