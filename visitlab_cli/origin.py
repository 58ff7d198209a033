"""Whose file is it? What visitlab draws, records and lays out says so in itself, and takes the place of nothing else.

A picture says it where its format has a place for its maker, a recording in the name of its application, a page in its
first line. What a run's folder holds under names of ours and does not say so is the user's.
"""

import os
import stat
import zlib
from pathlib import Path
from typing import Any

from visitlab_cli.errors import RunError, UsageError, reason

NAME = "visitlab"
METADATA: dict[str, dict[str, Any]] = {
    "svg": {"Creator": NAME, "Date": None},
    "png": {"Software": NAME},
    "pdf": {"Creator": NAME, "CreationDate": None},
}
"""What matplotlib writes into a picture of each format: its maker, and no time, which would differ."""
HTML, MARKDOWN = "<!doctype html>\n<!-- a report of visitlab -->\n", "<!-- made by `visitlab "
"""How each page begins."""
FAILURE = "visitlab: why a cell failed\n"
"""How the file of a failed cell's traceback begins."""
SCRIPT = "#!/bin/bash\n# visitlab: the jobs of a run\n"
JOB_LOG = "visitlab: the log of a job\n"
"""How the script of a run's jobs begins, and what each of these writes."""
_IN_PNG = f"tEXtSoftware\0{NAME}".encode()
_MARKS = {
    b"<?xml ": f"<dc:title>{NAME}</dc:title>".encode(),
    b"\x89PNG": _IN_PNG,
    b"%PDF": f"/Creator ({NAME})".encode(),
    b"RRF2": f"\n{chr(len(NAME))}{NAME}".encode(),
    HTML.encode(): b"",
    MARKDOWN.encode(): b"",
    FAILURE.encode(): b"",
    SCRIPT.encode(): b"",
    JOB_LOG.encode(): b"",
}
"""By how a file of a format begins, what one of ours has in it, too."""
_LOOKED_AT = 1 << 16
"""Bytes at either end of a file in which its mark is: a PDF says its maker last, all others first."""
_PNG_HEAD = 33
"""Bytes of a PNG before what may be said of it: signature and IHDR."""


def is_ours(file: Path) -> bool:
    """Whether a file says that visitlab wrote it; False for what is no regular file.

    Raises:
        OSError: it can't be read.
    """
    if not stat.S_ISREG(file.stat().st_mode):
        return False
    with file.open("rb") as there:
        first = there.read(_LOOKED_AT)
        there.seek(max(len(first), os.fstat(there.fileno()).st_size - _LOOKED_AT))
        last = there.read(_LOOKED_AT)
    return any(first.startswith(begin) and (mark in first or mark in last) for begin, mark in _MARKS.items())


def check_ours(file: Path) -> Path:
    """Refuse to write in the place of what is not visitlab's; what is not there yet, or is empty, is no hindrance.

    Returns:
        Where to write: the file, or of a link what it leads to.

    Raises:
        UsageError: something of somebody else's is there, or what is no file.
        RunError: it can't be read.
    """
    try:
        there = file.stat()
        if not stat.S_ISREG(there.st_mode):
            what = "folder" if stat.S_ISDIR(there.st_mode) else "device or pipe"
            raise UsageError(f"{file}: is a {what}; choose a file")
        if there.st_size and not is_ours(file):
            raise UsageError(f"{file}: exists and was not written by visitlab; move it away or choose another file")
    except (FileNotFoundError, NotADirectoryError):
        pass
    except OSError as error:
        raise RunError(f"{file}: can't be read: {reason(error)}") from error
    return Path(os.path.realpath(file)) if file.is_symlink() else file


def marked_png(content: bytes) -> bytes:
    """A PNG of another program's making that says, as ours do, that it was made for visitlab."""
    chunk = (len(_IN_PNG) - 4).to_bytes(4, "big") + _IN_PNG + zlib.crc32(_IN_PNG).to_bytes(4, "big")
    return content[:_PNG_HEAD] + chunk + content[_PNG_HEAD:]
