"""Nothing of a run lies behind a link: where something is to be written or looked for is checked, part by part."""

import os
import stat
from collections.abc import Iterable
from pathlib import Path

from visitlab_cli.errors import RunError, reason


def check_inside(run: Path, place: Path) -> None:
    """Refuse a `place` in a run's folder that is reached through a link, or that is a device or pipe.

    The run's folder itself may be a link. What is not there yet is no hindrance.

    Raises:
        RunError: it is, with what to do.
    """
    check_all_inside(run, [place.relative_to(run).as_posix()])


def check_all_inside(run: Path, places: Iterable[str]) -> None:
    """As `check_inside`, for many paths below the run, each folder on the way looked at once."""
    seen: set[str] = set()
    for place in places:
        parts = place.split("/")
        for length in range(1, len(parts) + 1):
            below = "/".join(parts[:length])
            if below not in seen:
                seen.add(below)
                _check(run / below, last=length == len(parts))


def _check(path: Path, *, last: bool) -> None:
    try:
        mode = os.lstat(path).st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise RunError(f"{path}: can't be reached: {reason(error)}") from error
    if stat.S_ISLNK(mode):
        what = f"is a link (to {_target(path)}), and nothing in a run is read or written through one"
    elif stat.S_ISDIR(mode) or (last and stat.S_ISREG(mode)):
        return
    else:
        what = "is a file where a folder belongs" if stat.S_ISREG(mode) else "is no folder and no file"
    raise RunError(f"{path}: {what}; move it away")


def _target(path: Path) -> str:
    try:
        return os.readlink(path)
    except OSError:
        return "?"


def is_real(path: Path) -> bool:
    """Whether a folder is there and is no link."""
    return path.is_dir() and not path.is_symlink()


def look_anew(run: Path, place: str) -> None:
    """Let the system forget that something was not there: a network file system asks again once a folder is opened."""
    folder = run
    for part in ("", *place.split("/")[:-1]):
        folder /= part
        try:
            os.close(os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC))
        except OSError:
            return
