"""Fixtures that several rooms share."""

import signal

import pytest
from hypothesis import settings

from tests.paper_runs import crossed_run, paper_run
from tests.program import TINY, the_run, visitlab
from tests.recorded_trials import trial_of
from tests.shared import made_once
from visitlab_cli.wording import start_comparing

settings.register_profile("visitlab", deadline=None)  # how fast an example is says something of the machine
settings.load_profile("visitlab")

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup the program would, rightly, be deaf to it

__all__ = ["crossed_run", "paper_run", "trial_of"]


@pytest.fixture(autouse=True)
def _names_are_compared_anew():
    """What other tests got wrong in the same process takes no suggestion from this one."""
    start_comparing()


@pytest.fixture(scope="session")
def tiny_run(tmp_path_factory):
    """A finished run of `tiny.yaml`, made by the real program with one worker; not to be changed."""

    def make(out):
        done = visitlab("run", TINY, "--out", out, "--workers", 1)
        assert done.returncode == 0, done.stderr

    return the_run(made_once(tmp_path_factory, "runs_of_tiny", make))
