"""Files that claim more than they hold, or hold more than they claim, take bounded memory and time."""

import io
import resource
import subprocess
import sys
from pathlib import Path

import lz4.frame
import numpy as np
import pytest
import zstandard

from . import raw
from .blocks import random_steps, record

MEMORY = 1536 << 20
"""Address space of a process that reads one; Python with numpy, numba and protobuf alone takes half of it."""
ZEROS = bytes(1 << 20)


def zstd_of(megabytes, **options):
    out = io.BytesIO()
    with zstandard.ZstdCompressor().stream_writer(out, closefd=False, **options) as stream:
        for _ in range(megabytes):
            stream.write(ZEROS)
    return out.getvalue()


def lz4_of(megabytes):
    out = io.BytesIO()
    with lz4.frame.open(out, "wb") as stream:
        for _ in range(megabytes):
            stream.write(ZEROS)
    return out.getvalue()


def limited(code, *arguments):
    """Runs Python code under a limit of its memory; what it printed."""
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=60,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


READ = """
import sys
from pathlib import Path
from visitlab_cli.errors import VisitlabError
from visitlab_cli.log.reader import read_attachment, read_steps, read_trial
from visitlab_cli.log.recovery.recovery import recover
for path in map(Path, sys.argv[1:]):
    for read in (read_steps, lambda path: read_trial(path, 77), lambda path: read_attachment(path, "x"), recover):
        try:
            read(path)
            print(path.name, "read")
        except VisitlabError as error:
            assert "\\n" not in str(error)
            print(path.name, type(error).__name__)
"""


def index_in_circles():
    """A summary whose offsets and indexes point at themselves."""
    start = len(raw.MAGIC) + len(raw.HEADER)
    index = raw.record(8, np.array([0, 0, start, 9], "<u8").tobytes() + bytes(30))
    return raw.whole(raw.HEADER, index * 1000, raw.record(0x0E, b"\x08" + np.array([start, start], "<u8").tobytes()))


def bombs():
    honest, far = 2000 << 20, 1 << 62
    yield "zstd-unsized", raw.whole(raw.HEADER, raw.chunk(b"", "zstd", size=100, crc=0, data=zstd_of(2000)))
    yield "zstd-sized", raw.whole(raw.HEADER, raw.chunk(b"", "zstd", size=100, crc=0, data=zstd_of(2000, size=honest)))
    yield "zstd-honest", raw.whole(raw.HEADER, raw.chunk(b"", "zstd", size=honest, crc=0, data=zstd_of(2000)))
    yield "lz4", raw.whole(raw.HEADER, raw.chunk(b"", "lz4", size=100, crc=0, data=lz4_of(1000)))
    for name, size in (("far", far), ("size", 1 << 31)):
        yield f"chunk-{name}", raw.whole(raw.HEADER, raw.chunk(b"", "zstd", size=size, crc=0, data=zstd_of(1)))
        prefix = bytes([9]) + size.to_bytes(8, "little")
        yield f"record-{name}", raw.MAGIC + raw.HEADER + prefix + ZEROS
        yield f"records-{name}", raw.MAGIC + raw.HEADER + prefix * 100_000
    # each attachment holds all that follow, and its CRC is wrong
    count, head = 20_000, 9 + 16 + 4 + 4 + 8
    end = count * head + (8 << 20)
    nested = b"".join(
        bytes([9])
        + (end - place * head - 9).to_bytes(8, "little")
        + bytes(24)
        + (end - place * head - head - 4).to_bytes(8, "little")
        for place in range(count)
    )
    yield "attachments-in-each-other", raw.MAGIC + raw.HEADER + nested + b"\1" * (8 << 20)
    yield "circles", index_in_circles()


def test_bombs_take_bounded_memory(tmp_path):
    files = []
    for name, content in bombs():
        files.append(tmp_path / f"{name}.mcap")
        files[-1].write_bytes(content)
    told = limited(READ, *files).splitlines()
    assert len(told) == 4 * len(files)
    assert {line.split()[1] for line in told} == {"RunError"}


LOOK_FOR = """
import sys
from pathlib import Path
from visitlab_cli.errors import NotFoundError
from visitlab_cli.log.reader import read_trial
import resource
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    read_trial(Path(sys.argv[1]), 10**6)
except NotFoundError as error:
    print(error)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


def test_a_trial_that_does_not_exist_is_looked_for_in_bounded_memory(tmp_path):
    columns, rows = random_steps(6000, 100)
    path = record(tmp_path / "a.mcap", "visit", columns, rows)
    words, kilobytes = limited(LOOK_FOR, path).splitlines()
    assert words == f"{path}: trial 1000000 is not recorded; the log holds 0 to 5999"
    assert int(kilobytes) < 20_000  # 600,000 rows are 70 MB


@pytest.mark.parametrize("path", [Path("/dev/zero"), Path("/dev/null")])
def test_a_device_is_no_file(path):
    assert "RunError" in limited(READ, path)
