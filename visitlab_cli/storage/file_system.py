"""What the file system of a folder can do of that which a run needs, and how fast."""

import errno
import os
import re
import shutil
import time
import uuid
from pathlib import Path
from typing import NamedTuple

from visitlab_cli.errors import reason
from visitlab_cli.storage.cell_folder import sync
from visitlab_cli.storage.locks import HeldError, lock, lock_of_other

LONG_AGO = 1e9
"""A time in seconds that no file made now has."""
MOUNTS = Path("/proc/self/mountinfo")
ESCAPED = re.compile(r"\\([0-7]{3})")
NETWORK = re.compile(r"nfs\d*|lustre|gpfs|beegfs|ceph|cifs|smb3?|afs|orangefs|pvfs2|panfs|wekafs|glusterfs|9p|fuse\..+")
"""Types of file systems that several machines may see."""
LOCAL = re.compile(r"ext[234]|xfs|btrfs|zfs|f2fs|tmpfs|ramfs|overlay|apfs|hfs|vfat|exfat")
"""Types that one machine sees alone."""
LOCKS_HERE = {"nolock", "local_lock=flock", "local_lock=all", "localflock"}
"""Options of a mount with which a lock holds on this machine alone."""


def existing(folder: Path) -> Path:
    """The folder, or what of the way to it there is: a run makes the rest, though not through a link to nowhere."""
    return next(
        place for place in (folder.absolute(), *folder.absolute().parents) if place.exists() or place.is_symlink()
    )


def hindrance(folder: Path) -> str:
    """Why nothing can be written in a folder, or made where it would be made; empty where it can."""
    place = existing(folder)
    if place.is_dir() and os.access(place, os.W_OK | os.X_OK):
        return ""
    if place.is_dir():
        read_only = os.statvfs(place).f_flag & os.ST_RDONLY
        what = "is on a disk that can only be read" if read_only else "is not yours to write"
    elif place.is_file():
        what = "is a file, not a folder"
    else:
        what = "is a link to nothing" if place.is_symlink() else "is no folder"
    return what if place == folder.absolute() else f"{place} {what}"


def what_works(folder: Path) -> dict[str, str]:
    """Whether a folder's file system `creates`, `locks`, `renames`, shows `times`, `syncs`: what is wrong, or nothing.

    Nothing is left behind.
    """
    probe = folder / f".tmp-probe-{uuid.uuid4().hex[:8]}"
    found = {}
    try:
        for check in (creates, locks, renames, times, syncs):
            try:
                probe.mkdir()
                check(probe)
                found[check.__name__] = ""
            except OSError as error:
                found[check.__name__] = reason(error)
            finally:
                shutil.rmtree(probe, ignore_errors=True)
    finally:
        shutil.rmtree(probe, ignore_errors=True)
    return found


def creates(folder: Path) -> None:
    """Of two who make the same file or folder, one is told that it is there: so one cell has one who does it."""
    for make in (_new_file, Path.mkdir):
        make(folder / make.__name__)
        try:
            make(folder / make.__name__)
        except FileExistsError:
            continue
        raise OSError(errno.EINVAL, "two may make the same file")


def _new_file(file: Path) -> None:
    os.close(os.open(file, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o644))


def locks(folder: Path) -> None:
    """A file is locked by one alone."""
    try:
        held = lock(folder / "file")
    except HeldError:
        raise OSError(errno.ENOLCK, "a new file is locked") from None
    try:
        if not held.works:
            raise OSError(errno.ENOLCK, "no locks are to be had")
        lock_of_other(held.file).release(remove=False)
        raise OSError(errno.ENOLCK, "two may lock the same file")
    except HeldError:
        pass
    finally:
        held.release(remove=False)


def renames(folder: Path) -> None:
    """A file takes another's place, a folder a free one, but none that is taken: so the first to finish wins."""
    ours, theirs = folder / "ours", folder / "theirs"
    for each in (ours, theirs):
        each.mkdir()
        (each / "file").touch()
    os.replace(ours / "file", theirs / "file")
    (ours / "file").touch()
    try:
        ours.rename(theirs)
    except OSError:
        ours.rename(folder / "free")
        return
    raise OSError(errno.EINVAL, "a folder takes the place of one that is not empty")


def times(folder: Path) -> None:
    """That a file was touched can be seen: so whoever writes gives a sign of life."""
    file = folder / "file"
    descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o644)
    try:
        os.utime(file, (LONG_AGO, LONG_AGO))
        os.utime(descriptor)
    finally:
        os.close(descriptor)
    if file.stat().st_mtime == LONG_AGO:
        raise OSError(errno.EINVAL, "that a file was touched is not to be seen")


def syncs(folder: Path) -> None:
    """What was written can be waited for until it is on the disk."""
    (folder / "file").write_bytes(b"content")
    for place in (folder / "file", folder, folder.parent):
        sync(place)


def seconds_of_a_sync(folder: Path, tries: int = 5) -> float:
    """How long it takes until a small new file is on the disk: the median of some tries; nothing is left behind.

    Raises:
        OSError: it can't be written.
    """
    probe, spent = folder / f".tmp-probe-{uuid.uuid4().hex[:8]}", []
    try:
        for _ in range(tries):
            probe.write_bytes(b"content")
            before = time.perf_counter()
            sync(probe)
            spent.append(time.perf_counter() - before)
            probe.unlink()
    finally:
        probe.unlink(missing_ok=True)
    return sorted(spent)[tries // 2]


class Mount(NamedTuple):
    """The file system that a folder lies on: its type and the options it was mounted with."""

    type: str
    options: frozenset[str]

    @property
    def is_local(self) -> bool:
        """Whether surely no other machine sees it."""
        return LOCAL.fullmatch(self.type) is not None

    @property
    def is_shared(self) -> bool:
        """Whether other machines may see it."""
        return NETWORK.fullmatch(self.type) is not None

    @property
    def locks_here_alone(self) -> str:
        """Why a lock says nothing to other machines, an option of the mount; empty where it may."""
        if not self.is_shared:
            return ""
        if self.type == "lustre" and "flock" not in self.options:
            return "no option flock"
        return ", ".join(sorted(self.options & LOCKS_HERE))


def mount_of(folder: Path, mounts: Path = MOUNTS) -> Mount | None:
    """What a folder lies on; None where the system does not tell."""
    try:
        lines = mounts.read_text(encoding="utf-8", errors="surrogateescape").splitlines()
    except OSError:
        return None
    place, found, longest = Path(os.path.realpath(folder)), None, -1
    for line in lines:
        before, _, after = line.partition(" - ")
        mounted, types = before.split(), after.split()
        if len(mounted) < 6 or len(types) < 3:
            continue
        point = Path(ESCAPED.sub(lambda octal: chr(int(octal[1], 8)), mounted[4]))
        if place.is_relative_to(point) and len(point.parts) >= longest:  # a later mount hides what it lies on
            longest, options = len(point.parts), f"{mounted[5]},{types[2]}"
            found = Mount(types[0], frozenset(options.split(",")))
    return found
