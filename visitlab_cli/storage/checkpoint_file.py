"""The file of a checkpoint: a line of JSON that says of what, the arrays as a compressed npz, and a signature.

What it holds goes to kernels as it is, and these check no bounds. So it is believed only with the signature of the
user (an HMAC with sha256 and a secret, `key.py`), which also tells what is damaged: nobody else can write one.
"""

import hashlib
import hmac
import io
import json
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from visitlab_cli.storage.reading import MOST_JSON, MOST_TABLE, UnreadableError, open_file, parse_json

if TYPE_CHECKING:
    from visitlab_cli.storage.npz import Arrays

NAMES = ("checkpoint-0", "checkpoint-1")
"""Written by turns."""
UNFINISHED = "checkpoint-new"
_PATH = re.compile(r"(?!\.)[^/\0]+(/(?!\.)[^/\0]+)*")
_SIGNATURE = hashlib.sha256().digest_size


class Checkpoint(NamedTuple):
    """What can be said in JSON, and arrays by name."""

    facts: dict[str, Any]
    arrays: "Arrays"


def encoded(checkpoint: Checkpoint, key: bytes) -> bytes:
    """The bytes of the file.

    Raises:
        ValueError: they are more than are ever read.
    """
    import numpy as np
    import zstandard

    packed = io.BytesIO()
    np.savez(packed, **checkpoint.arrays)  # type: ignore[arg-type]  # (its stub takes any name for an option)
    line = json.dumps(checkpoint.facts, sort_keys=True, allow_nan=False).encode() + b"\n"
    content = line + zstandard.ZstdCompressor(level=1).compress(packed.getbuffer())
    if len(line) > MOST_JSON or len(content) + _SIGNATURE > MOST_TABLE:
        raise ValueError("too large")
    return content + hmac.digest(key, content, "sha256")


def decoded(content: bytes, key: bytes) -> Checkpoint:
    """The checkpoint of a file's bytes.

    Raises:
        ValueError: it is damaged, or this user did not write it.
    """
    import numpy as np
    import zstandard

    signed, signature = content[:-_SIGNATURE], content[-_SIGNATURE:]
    if not hmac.compare_digest(hmac.digest(key, signed, "sha256"), signature):
        raise ValueError("damaged, or somebody else's")
    line, _, packed = signed.partition(b"\n")
    with np.load(io.BytesIO(zstandard.ZstdDecompressor().decompress(packed)), allow_pickle=False) as arrays:
        return Checkpoint(parse_json(line.decode()), dict(arrays))


def write(folder: Path, name: str, content: bytes) -> None:
    """Write a checkpoint in a folder so that it is there whole, on the disk, or not at all.

    Raises:
        OSError: it can't be written.
    """
    with (folder / UNFINISHED).open("wb") as stream:
        stream.write(content)
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(folder / UNFINISHED, folder / name)


def stated(file: Path) -> dict[str, Any]:
    """What a checkpoint says in its first line, which anybody may have written; nothing where it says nothing."""
    try:
        with open_file(file) as stream:
            facts = parse_json(stream.readline(MOST_JSON).decode())
    except (OSError, ValueError, UnreadableError):
        return {}
    return facts if isinstance(facts, dict) else {}


def stated_cell(folder: Path) -> str | None:
    """The path of the cell that a folder's checkpoints are of; None where there is none, or none that can be."""
    paths = [stated(folder / name).get("cell") for name in NAMES]
    return next((path for path in paths if isinstance(path, str) and _PATH.fullmatch(path)), None)
