"""A file or folder that appears whole or not at all: written beside its place, then renamed."""

import contextlib
import os
import shutil
import uuid
from collections.abc import Iterator
from pathlib import Path

from visitlab_cli.errors import RunError, UsageError, reason
from visitlab_cli.origin import check_ours


@contextlib.contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to; what is there at the end of the block takes the place of `path`, even a link.

    Raises:
        RunError: it can't be written.
    """
    beside = path.with_name(f".tmp-{uuid.uuid4().hex[:8]}-{path.name[-100:]}")
    try:
        yield beside
        os.replace(beside, path)
    except OSError as error:
        raise RunError(f"{path}: can't be written: {reason(error)}") from error
    finally:
        with contextlib.suppress(OSError):
            beside.unlink(missing_ok=True)


@contextlib.contextmanager
def new_file(path: Path) -> Iterator[Path]:
    """As `whole_file`, but never in the place of another; a link to what is not there yet leads to the new file.

    Raises:
        UsageError: `path` exists.
        RunError: it can't be written.
    """
    if path.exists():
        raise UsageError(f"{path}: exists; choose another file with -o")
    with whole_file(check_ours(path)) as beside:
        yield beside


@contextlib.contextmanager
def new_folder(path: Path) -> Iterator[Path]:
    """A path to make a folder at, of the name of `path`, whose place it takes at the end of the block.

    The folders that `path` lies in are made where they are not there.

    Raises:
        UsageError: `path` exists.
        RunError: it can't be written.
    """
    if path.exists():
        raise UsageError(f"{path}: exists; choose another folder with -o")
    path = check_ours(path)
    beside = path.absolute().with_name(f".tmp-{uuid.uuid4().hex[:8]}-{path.name[-100:]}")
    try:
        beside.mkdir(parents=True)
        yield beside / path.name
        os.rename(beside / path.name, path)
    except OSError as error:
        raise RunError(f"{path}: can't be written: {reason(error)}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def write_whole(path: Path, content: bytes) -> None:
    """Write a file whole.

    Raises:
        RunError: it can't be written.
    """
    with whole_file(path) as beside:
        beside.write_bytes(content)


def write_again(path: Path, content: bytes) -> None:
    """Write a picture, recording or page whole, in the place of nothing but another that visitlab wrote.

    Of a link it is what the link leads to.

    Raises:
        UsageError: `path` is there and somebody else's, or no file.
        RunError: it can't be written.
    """
    write_whole(check_ours(path), content)
