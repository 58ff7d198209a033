"""The commands of docs/cluster.md work, in small, and leave what they should."""

import os
import re
import signal
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import pytest
from platformdirs import user_cache_path

from tests.dask_cluster import until
from tests.docs.cluster_page import blocks, with_queue
from tests.program import COMMAND, TINY, hashes, only_cells, the_run


@pytest.mark.slow
def test_the_commands_work_in_small(tiny_run, tmp_path):
    here = {
        "NO_COLOR": "1",
        "PYTHONPATH": os.pathsep.join(sys.path),
        "VISITLAB_CACHE": str(user_cache_path("visitlab")),
    }
    environment = os.environ | here | with_queue(tmp_path / "queue", runs=True)
    environment["PATH"] += os.pathsep + str(Path(sys.executable).parent)
    finished = 0
    for number, block in enumerate(blocks()):
        folder = tmp_path / str(number)
        folder.mkdir()
        with servers(folder, environment, [command for command in block if command.startswith("dask ")]):
            for command in block:
                if command.startswith("dask "):
                    continue
                small = re.sub(r"(?:quickstart|paper) seeds=\d+", str(TINY), command).replace("quickstart", "tiny")
                small = small.replace("--cells-per-job 20", "--cells-per-job 9").replace("--workers 16", "--workers 2")
                done = subprocess.run(
                    in_bash(small), cwd=folder, env=environment, capture_output=True, text=True, check=False
                )
                assert done.returncode == 0, f"{command}: {done.stderr}"
        if (folder / "runs").exists():
            assert only_cells(hashes(the_run(folder / "runs"))) == only_cells(hashes(tiny_run)), block
            finished += 1
    assert finished > 5


def in_bash(command):
    return ["bash", "-c", f'set -o pipefail; visitlab() {{ "{COMMAND[0]}" -P -m visitlab_cli "$@"; }}; {command}']


@contextmanager
def servers(folder, environment, commands):
    """Those that run until they are ended, each in a session of its own."""
    started = [
        subprocess.Popen(
            in_bash(command), cwd=folder, env=environment, start_new_session=True, stderr=subprocess.DEVNULL
        )
        for command in commands
    ]
    try:
        until((folder / "scheduler.json").exists if commands else lambda: True)
        yield
    finally:
        for process in started:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
