"""Who is writing: a lock file beside what is written, which says its owner and is locked as long as that one lives.

A regular file that is open for writing is locked, for on a network file system only that reaches other nodes. On
file systems that lock nothing the owner that the file states is all there is: its process on this machine, and
elsewhere whether the file was touched within an hour, by the file system's own clock.
"""

import contextlib
import errno
import fcntl
import json
import os
import socket
import stat
import time
import uuid
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from visitlab_cli.errors import RunError, reason

SILENT = 3600.0
"""Seconds without a sign of life after which an owner on another machine is gone."""
BEAT = 2.0
"""Seconds between two signs of life of a cell that is written."""
LONGEST = 4096
"""Bytes of a lock file that are read."""
HELD = {errno.EWOULDBLOCK, errno.EAGAIN}
READ_ONLY = {errno.EROFS, errno.EACCES, errno.EPERM}
TRIES = 100
LEFT = "left"
"""What an owner says that left something to go on from, though its process may live."""
ENDED = ("Z", "X")
"""The states of a process that does nothing any more."""


class HeldError(Exception):
    """Somebody else holds the lock."""


class Lock(NamedTuple):
    """An open lock file; `works` says whether its file system locks at all."""

    file: Path
    descriptor: int
    works: bool

    def state(self, **told: object) -> None:
        """Say in the file who has it, and what else there is to tell.

        Raises:
            OSError: it can't be written.
        """
        content = json.dumps({**_me(), **told}).encode()
        os.pwrite(self.descriptor, content, 0)
        os.ftruncate(self.descriptor, len(content))
        os.utime(self.descriptor)  # which sends it to where others read it

    def beat(self, **told: object) -> None:
        """Give a sign of life, and say what there is to tell; where none can be given, none is."""
        with contextlib.suppress(OSError):
            if told:
                self.state(**told)
            else:
                os.utime(self.descriptor)

    def release(self, *, remove: bool) -> None:
        """Let go, and take the file away where it is no longer of use and still this one."""
        if remove:
            with contextlib.suppress(OSError):
                if _is_still(self.file, self.descriptor):
                    self.file.unlink()
        os.close(self.descriptor)

    def leave(self) -> None:
        """Let go, and say so: who wants goes on from what is left."""
        with contextlib.suppress(OSError):
            self.state(**{LEFT: True})
        os.close(self.descriptor)


def lock(file: Path, *, shared: bool = False, new: bool = False, **told: object) -> Lock:
    """Lock `file`, made where it is not there, for this process, or for all that share it.

    Args:
        file: the lock file.
        shared: whether others may have it, too; then it says nothing.
        new: whether it must not be there yet.
        told: what it says beside its owner.

    Raises:
        HeldError: somebody else has it.
        OSError: it can't be made; FileExistsError: it was to be new.
    """
    for _ in range(TRIES):
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC
        descriptor = os.open(file, flags | (os.O_EXCL if new else 0), 0o644)
        try:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                raise OSError(errno.EINVAL, "is no file")
            works = _flock(descriptor, fcntl.LOCK_SH if shared else fcntl.LOCK_EX)
            if _is_still(file, descriptor):
                held = Lock(file, descriptor, works)
                if not shared:
                    held.state(**told)
                return held
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)  # its owner removed it between our opening and locking it
    raise HeldError(str(file))


def _flock(descriptor: int, how: int) -> bool:
    """Whether the file system locks; where it does not, there is no lock to wait for."""
    try:
        fcntl.flock(descriptor, how | fcntl.LOCK_NB)
    except OSError as error:
        if error.errno in HELD:
            raise HeldError from error
        return False
    return True


def _is_still(file: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(os.lstat(file), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _me() -> dict[str, Any]:
    return {"machine": _machine(), "process": os.getpid(), "started": _started(os.getpid())}


@cache
def _machine() -> str:
    """This machine since it was started, and its processes' numbers: no two that could meet on a disk are alike."""
    told = [socket.gethostname()]
    for place, read in (("/proc/sys/kernel/random/boot_id", _text), ("/proc/self/ns/pid", os.readlink)):
        with contextlib.suppress(OSError):
            told.append(read(place).strip())
    return " ".join(told)


def _text(place: str) -> str:
    return Path(place).read_text(encoding="utf-8")


def _started(process: int) -> str:
    """When a process was started, in the system's ticks; empty where the system does not tell, or it has ended.

    Of one that has ended the system keeps the number until its parent asks, which may be never.
    """
    try:
        state, *fields = _text(f"/proc/{process}/stat").rpartition(")")[2].split()
        return "" if state in ENDED else fields[18]
    except (OSError, IndexError, ValueError):
        return ""


def is_abandoned(file: Path, *, begun: bool = True, remove: bool = False) -> bool:
    """Whether who made a lock file is surely gone; also where there is no file any more.

    Args:
        file: the lock file.
        begun: whether what it locks is there; its owner states itself before that.
        remove: whether to take the file away then, before anybody can lock it.
    """
    try:
        held = lock_of_other(file)
    except FileNotFoundError:
        return True
    except (HeldError, OSError):
        return False
    gone: bool | None = False
    try:
        gone = is_gone(owner_in(held.descriptor), told=begun or not held.works)
        if gone is None:
            gone = _clock(file.parent) - os.fstat(held.descriptor).st_mtime > SILENT
    except OSError:
        pass
    finally:
        held.release(remove=remove and bool(gone))
    return bool(gone)


def is_gone(owner: dict[str, Any], *, told: bool) -> bool | None:
    """Whether the owner of a file that nobody locks is gone; None where this machine can't tell.

    Args:
        owner: what the file says of it.
        told: whether it must have said something; one that was killed before is gone, and who is only about to say it
            makes another file.
    """
    if not owner and not told:
        return True
    if owner.get(LEFT) is True:
        return True
    if owner.get("machine") == _machine():
        return not lives(owner)
    same_machine = str(owner.get("machine", "")).split(" ")[0] == socket.gethostname()
    return True if same_machine and len(_machine().split(" ")) > 1 and _other_boot(owner) else None


Changes = tuple[int, ...]
"""Of a lock file: what is another after each sign of life, whatever the clocks say."""


def owner_unless(is_silent: Callable[[Changes], bool], file: Path) -> dict[str, Any] | None:
    """What a lock file says of its owner; None where that one is gone, or silent: then the file is taken away.

    Raises:
        FileNotFoundError: it is not there, or not any more.
        OSError: it can't be opened.
    """
    descriptor = _open_file(file)
    try:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode):
            raise OSError(errno.EINVAL, "is no file")
        owner = owner_in(descriptor)
        try:
            gone = is_gone(owner, told=not _flock(descriptor, fcntl.LOCK_EX))
        except HeldError:
            gone = False
        if not _is_still(file, descriptor):
            raise FileNotFoundError
        if gone or is_silent((status.st_ino, status.st_mtime_ns, status.st_ctime_ns)):
            file.unlink()
            return None
        return owner
    finally:
        os.close(descriptor)


def _open_file(file: Path) -> int:
    return os.open(file, os.O_RDWR | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)


def lock_of_other(file: Path) -> Lock:
    """Lock what is there, without making it or stating an owner.

    Raises:
        FileNotFoundError: it is not there.
        HeldError: somebody has it.
        OSError: it can't be opened.
    """
    descriptor = _open_file(file)
    try:
        return Lock(file, descriptor, _flock(descriptor, fcntl.LOCK_EX))
    except BaseException:
        os.close(descriptor)
        raise


def told_in(file: Path) -> dict[str, Any]:
    """What a lock file says of its owner and of what that does; empty where there is nothing that can be read."""
    try:
        descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError:
        return {}
    try:
        return owner_in(descriptor)
    except OSError:
        return {}
    finally:
        os.close(descriptor)


def owner_in(descriptor: int) -> dict[str, Any]:
    """What an open lock file says of its owner; empty where it says nothing that can be read."""
    try:
        owner = json.loads(os.pread(descriptor, LONGEST, 0))
    except (ValueError, RecursionError):
        return {}
    return owner if isinstance(owner, dict) else {}


def _other_boot(owner: dict[str, Any]) -> bool:
    theirs, ours = str(owner.get("machine", "")).split(" "), _machine().split(" ")
    return len(theirs) == len(ours) > 1 and theirs[1] != ours[1]


def lives(owner: dict[str, Any]) -> bool:
    """Whether the owner, a process of this machine, lives."""
    process = owner.get("process")
    if not isinstance(process, int) or process <= 0:
        return False
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        pass  # it lives, and is another user's
    return owner.get("started") in (_started(process), "")


def _clock(folder: Path) -> float:
    """The time by the clock of the file system that a folder lies on."""
    probe = folder / f".tmp-clock-{uuid.uuid4().hex[:8]}"
    try:
        probe.touch()
        return probe.stat().st_mtime
    finally:
        with contextlib.suppress(OSError):
            probe.unlink()


def older_than(path: Path, seconds: float) -> bool:
    """Whether nothing touched a path for so long, by its file system's clock."""
    try:
        return _clock(path.parent) - path.lstat().st_mtime > seconds
    except OSError:
        return False


RUN_LOCK = ".lock"


@contextmanager
def being_written(run: Path, say: Callable[[str], None] | None = None) -> Iterator[None]:
    """Hold a run, which then nobody removes; others may write in it, too.

    A run in which we may not write can't be held: what only reads it goes on, what writes will say so.

    Raises:
        RunError: it is being removed, or nothing can be written there.
    """
    held = None
    try:
        held = lock(run / RUN_LOCK, shared=True)
    except HeldError:
        raise RunError(f"{run}: is being removed; do it again when that is over") from None
    except OSError as error:
        if error.errno not in READ_ONLY or not run.is_dir():
            raise RunError(f"{run}: can't be written: {reason(error)}") from error
    if held is not None and not held.works and say is not None:
        say(f"{run}: its file system locks nothing: don't remove the run while it is written")
    try:
        yield
    finally:
        if held is not None:
            held.release(remove=held.works and _is_last(held))


def _is_last(held: Lock) -> bool:
    """Whether nobody else holds a shared lock; it is then ours alone."""
    try:
        return _flock(held.descriptor, fcntl.LOCK_EX)
    except HeldError:
        return False


@contextmanager
def to_remove(run: Path) -> Iterator[None]:
    """Hold a run alone.

    Raises:
        RunError: somebody writes in it, or it can't be held.
    """
    try:
        held = lock(run / RUN_LOCK)
    except HeldError:
        raise RunError(f"{run}: is being written; stop that first") from None
    except OSError as error:
        raise RunError(f"{run}: can't be changed: {reason(error)}") from error
    try:
        yield
    finally:
        held.release(remove=True)


class Heart:
    """Gives signs of life for a lock, every two seconds at most."""

    def __init__(self, held: Lock) -> None:
        """Of `held`."""
        self._held = held
        self._last = time.monotonic()

    def beat(self, **told: object) -> None:
        """Give one, if it is time, with what there is to tell."""
        now = time.monotonic()
        if now - self._last >= BEAT:
            self._last = now
            self._held.beat(**told)
