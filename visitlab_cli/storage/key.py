"""A secret of the user's, by which what visitlab wrote for this user is told from whatever else lies in a folder.

It lies in the user's own folder for state, on a cluster one that all nodes share, and never in a run.
"""

import contextlib
import os
import secrets
import uuid
from pathlib import Path

import platformdirs

from visitlab_cli.kernel_cache import unsafe
from visitlab_cli.storage.reading import UnreadableError, read_bytes

BYTES = 32


def own_key(*, make: bool = False) -> bytes | None:
    """The secret, with `make` a new one where there is none; None where none can be kept that is ours alone."""
    try:
        folder = Path(os.path.realpath(platformdirs.user_state_path("visitlab")))
        file = folder / "key"
        if make and not file.exists():
            _make(file)
        if unsafe(folder):
            return None
        found = read_bytes(file, BYTES)
    except (OSError, ValueError, RuntimeError, UnreadableError):  # RuntimeError: the user has no home folder
        return None
    return found if len(found) == BYTES else None


def _make(file: Path) -> None:
    for missing in (above for above in reversed(file.parents) if not above.exists()):
        missing.mkdir(mode=0o700, exist_ok=True)
    beside = file.with_name(f".tmp-{uuid.uuid4().hex[:8]}-key")
    try:
        with open(os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "wb") as stream:
            stream.write(secrets.token_bytes(BYTES))
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(beside, file)
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
