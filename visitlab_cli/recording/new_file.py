"""A file that appears whole or not at all, and never in the place of another."""

import contextlib
import os
import uuid
from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.errors import RunError, UsageError


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to; what is there at the end of the block is renamed to `path`.

    Raises:
        UsageError: `path` exists.
        RunError: it cannot be written.
    """
    if path.exists():
        raise UsageError(f"{path}: exists; choose another file with -o")
    beside = path.with_name(f".tmp-{uuid.uuid4().hex[:8]}")
    try:
        yield beside
        os.replace(beside, path)
    except OSError as error:
        raise RunError(f"{path}: cannot be written: {error.strerror}") from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)
