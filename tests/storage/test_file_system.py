"""What a folder's file system can do is found by trying, and nothing is left behind."""

import errno
import fcntl
import os
import shutil
from pathlib import Path

import pytest

from visitlab_cli.storage.file_system import mount_of, seconds_of_a_sync, what_works

REAL = {"open": os.open, "rename": Path.rename, "utime": os.utime}


def test_a_healthy_folder_can_do_all(tmp_path):
    assert what_works(tmp_path) == dict.fromkeys(("creates", "locks", "renames", "times", "syncs"), "")
    assert seconds_of_a_sync(tmp_path) > 0
    assert list(tmp_path.iterdir()) == []


def no_sync(descriptor):
    raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))


def rename_over(folder, place):
    shutil.rmtree(place, ignore_errors=True)
    return REAL["rename"](folder, place)


def touched_by_name_only(path, *times):
    if not isinstance(path, int):
        REAL["utime"](path, *times)


LIARS = {
    "creates": (os, "open", lambda path, flags, *mode, **more: REAL["open"](path, flags & ~os.O_EXCL, *mode, **more)),
    "locks": (fcntl, "flock", lambda descriptor, how: None),
    "renames": (Path, "rename", rename_over),
    "times": (os, "utime", touched_by_name_only),
    "syncs": (os, "fsync", no_sync),
}


@pytest.mark.parametrize("what", LIARS)
def test_one_that_only_says_that_it_did_is_found_out(what, tmp_path, monkeypatch):
    monkeypatch.setattr(*LIARS[what])
    found = what_works(tmp_path)
    assert [name for name, problem in found.items() if problem] == [what]
    monkeypatch.undo()
    assert list(tmp_path.iterdir()) == []


MOUNTS = """\
22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw
30 22 0:40 / /net rw,noatime shared:2 master:1 - nfs4 server:/net rw,vers=4.2,local_lock=none
31 22 0:41 / /old rw - nfs server:/old rw,vers=3,nolock,local_lock=all
32 22 0:42 / /with\\040space rw - lustre mds:/scratch rw,flock
33 22 0:43 / /lustre rw - lustre mds:/scratch rw
34 22 0:44 / /new rw - somefs x rw
35 30 0:45 / /net/mine rw - tmpfs tmpfs rw
"""


@pytest.mark.parametrize(
    ("folder", "kind", "local", "shared", "alone"),
    [
        ("/var/runs", "ext4", True, False, ""),
        ("/net/yours/runs", "nfs4", False, True, ""),
        ("/net/mine/runs", "tmpfs", True, False, ""),
        ("/nets", "ext4", True, False, ""),
        ("/old", "nfs", False, True, "local_lock=all, nolock"),
        ("/with space/runs", "lustre", False, True, ""),
        ("/lustre", "lustre", False, True, "no option flock"),
        ("/new", "somefs", False, False, ""),
    ],
)
def test_what_a_folder_lies_on(folder, kind, local, shared, alone, tmp_path):
    (tmp_path / "mountinfo").write_text(MOUNTS)
    mount = mount_of(Path(folder), tmp_path / "mountinfo")
    assert (mount.type, mount.is_local, mount.is_shared, mount.locks_here_alone) == (kind, local, shared, alone)
    assert mount_of(Path(folder), tmp_path / "none") is None
