"""What cleans up after killed processes says nothing between the lines of a run."""

import subprocess
import sys

PROGRAM = """
import multiprocessing, os, signal, sys, time, warnings
from multiprocessing import resource_tracker
from visitlab_cli.execution.tracker import survive
warnings.simplefilter("ignore")
if sys.argv[1] == "surviving":
    survive()
lock = multiprocessing.get_context("forkserver").Lock()
os.kill(resource_tracker._resource_tracker._pid, signal.SIGKILL)
os.waitpid(resource_tracker._resource_tracker._pid, 0)
resource_tracker.ensure_running()
print("a line", file=sys.stderr, flush=True)
del lock
import gc; gc.collect()
time.sleep(0.3)
"""


def said(how):
    done = subprocess.run([sys.executable, "-c", PROGRAM, how], capture_output=True, text=True, check=True)
    return done.stderr


def test_one_that_was_started_anew_writes_no_traceback():
    assert said("surviving") == "a line\n"
    assert "KeyError" in said("as it is")
