"""What the file system of a folder can do of that which a run needs: lock, rename, sync."""

import contextlib
import errno
import os
import uuid
from pathlib import Path

from visitlab_cli.errors import reason
from visitlab_cli.storage.locks import HeldError, lock


def what_works(folder: Path) -> dict[str, str]:
    """Whether a folder's file system `locks`, `renames` and `syncs`: what is wrong with each, or nothing."""
    probe, other = (folder / f".tmp-probe-{uuid.uuid4().hex[:8]}" for _ in range(2))

    def locks() -> None:
        held = lock(probe)
        held.release(remove=False)
        if not held.works:
            raise OSError(errno.ENOLCK, "no locks are to be had")

    def renames() -> None:
        probe.rename(other)
        other.rename(probe)

    def syncs() -> None:
        for place in (probe, folder):
            descriptor = os.open(place, os.O_RDONLY)
            try:
                os.fsync(descriptor)
            finally:
                os.close(descriptor)

    found = {}
    try:
        for check in (locks, renames, syncs):
            try:
                check()
                found[check.__name__] = ""
            except (OSError, HeldError) as error:
                found[check.__name__] = reason(error) if isinstance(error, OSError) else "a new file is locked"
    finally:
        with contextlib.suppress(OSError):
            probe.unlink(missing_ok=True)
    return found
