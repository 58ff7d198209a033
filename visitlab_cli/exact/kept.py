"""Exact values that take long, kept in the user's cache folder: each by all that decides it, so never stale."""

import contextlib
import hashlib
import json
from collections.abc import Callable

from visitlab_cli.compiled import KERNEL_SOURCES
from visitlab_cli.errors import RunError
from visitlab_cli.kernel_cache import place
from visitlab_cli.sources import digest_of, files_of
from visitlab_cli.whole_file import write_whole

DECIDING = (*KERNEL_SOURCES, "exact")
"""The rooms on the way to an exact value."""
VALUE, DECIDED_BY = "value", "decided_by"


def kept(compute: Callable[[], float], *decided_by: object) -> float:
    """What `compute` gives, or gave in an earlier process of the same code.

    Where nothing can be kept, or what was kept is damaged, it is computed.

    Args:
        compute: what to ask where it is not known.
        *decided_by: what the value is, and all that it depends on beside the code: numbers, words and tuples of them.
    """
    key = repr(decided_by)
    folder = place(f"exact-{digest_of(files_of(DECIDING)).hexdigest()[:16]}").folder
    if folder is None:
        return compute()
    file = folder / f"{_digest(key)[:16]}.txt"
    with contextlib.suppress(OSError, ValueError):
        digest, content = file.read_text().split("\n", 1)
        if digest == _digest(content) and json.loads(content)[DECIDED_BY] == key:
            return float.fromhex(json.loads(content)[VALUE])
    value = compute()
    content = json.dumps({DECIDED_BY: key, VALUE: value.hex()})
    with contextlib.suppress(RunError):
        write_whole(file, f"{_digest(content)}\n{content}".encode())
    return value


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()
