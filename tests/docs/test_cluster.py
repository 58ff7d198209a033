"""The commands of docs/cluster.md work, in small, and leave what they should."""

import os
import re
import subprocess
import sys

import pytest
from platformdirs import user_cache_path

from tests.docs.cluster_page import blocks, with_queue
from tests.program import COMMAND, TINY, hashes, only_cells, the_run


@pytest.mark.slow
def test_the_commands_work_in_small(tiny_run, tmp_path):
    script = f'set -o pipefail; visitlab() {{ "{COMMAND[0]}" -P -m visitlab_cli "$@"; }}; '
    here = {
        "NO_COLOR": "1",
        "PYTHONPATH": os.pathsep.join(sys.path),
        "VISITLAB_CACHE": str(user_cache_path("visitlab")),
    }
    environment = os.environ | here | with_queue(tmp_path / "queue", runs=True)
    finished = 0
    for number, block in enumerate(blocks()):
        folder = tmp_path / str(number)
        folder.mkdir()
        for command in block:
            small = re.sub(r"(?:quickstart|paper) seeds=\d+", str(TINY), command).replace("quickstart", "tiny")
            small = small.replace("--cells-per-job 20", "--cells-per-job 9").replace("--workers 16", "--workers 2")
            done = subprocess.run(
                ["bash", "-c", script + small], cwd=folder, env=environment, capture_output=True, text=True, check=False
            )
            assert done.returncode == 0, f"{command}: {done.stderr}"
        if (folder / "runs").exists():
            assert only_cells(hashes(the_run(folder / "runs"))) == only_cells(hashes(tiny_run)), block
            finished += 1
    assert finished > 3
