"""Where machine code is kept: in a folder that is ours alone, since what lies there is executed; else nowhere.

numba unpickles what it finds, so whoever can write there runs code as us. And it fails where it can't write: a disk
that is full or read-only, or a damaged file, is no cache at all and never an error.
"""

import contextlib
import hashlib
import os
import pickle
import shutil
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numba
import platformdirs
from numba.core import caching, sigutils

from visitlab_cli.errors import reason

ROOM_FOR_CACHE = 64 * 2**20  # bytes: less is a disk that will be full before a run ends
VARIABLE = "VISITLAB_CACHE"
DIGEST = hashlib.sha256().digest_size
_caching: Any = caching  # which has no types
_settings: Any = numba.config
_signatures: Any = sigutils
OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH


class Place(NamedTuple):
    """The folder, or None and why there is none."""

    folder: Path | None
    why: str = ""


def place(name: str) -> Place:
    """The folder `name` in the user's cache folder or in that of the variable, made private if it is not there."""
    folder = None
    try:
        folder = Path(os.path.realpath(os.environ.get(VARIABLE) or platformdirs.user_cache_path("visitlab"))) / name
        for missing in (above for above in (*reversed(folder.parents), folder) if not above.exists()):
            missing.mkdir(mode=0o700, exist_ok=True)  # one by one: of parents mkdir takes the user's own mode
        if wrong := unsafe(folder):
            return Place(None, wrong)
        if not os.access(folder, os.W_OK | os.X_OK):
            return Place(None, f"{folder} can't be written")
        if shutil.disk_usage(folder).free < ROOM_FOR_CACHE:
            return Place(None, f"the disk of {folder} is full")
    except (OSError, ValueError) as error:
        return Place(None, f"{folder or 'the cache folder'}: {reason(error)}")
    except RuntimeError:
        return Place(None, "the user has no home folder")
    return Place(folder)


def unsafe(folder: Path) -> str:
    """Why somebody else could have put something into a folder, or put another one in its place; empty if nobody."""
    if not hasattr(os, "geteuid"):
        return ""
    there = folder.lstat()
    if not stat.S_ISDIR(there.st_mode):
        return f"{folder} is a link"
    if there.st_uid != os.geteuid():
        return f"{folder} belongs to another user"
    if there.st_mode & OTHERS_WRITE:
        return f"others can write to {folder}"
    for above in folder.parents:
        there = above.stat()
        if there.st_uid not in (0, os.geteuid()):
            return f"{above} belongs to another user"
        if _others_write(there) and not there.st_mode & stat.S_ISVTX:
            return f"others can write to {above}"
    return ""


def _others_write(there: os.stat_result) -> bool:
    """Whether others than the owner can; a group of the user's own, named by the same number, is no other."""
    own_group = there.st_gid == os.getegid() == os.geteuid()
    return bool(there.st_mode & (stat.S_IWOTH if own_group else OTHERS_WRITE))


class _CheckedFiles(_caching.IndexDataCacheFile):  # type: ignore[misc]
    """numba's files of a kernel, each behind its sha256: of what is not whole nothing is unpickled, let alone run."""

    def _save_index(self, overloads: Any) -> None:
        self._write(self._index_path, (self._source_stamp, overloads))

    def _load_index(self) -> Any:
        if not os.path.exists(self._index_path):
            return {}
        stamp, overloads = self._read(self._index_path)
        return overloads if stamp == self._source_stamp else {}

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _load_data(self, name: str) -> Any:
        return self._read(self._data_path(name))

    def _write(self, path: str, data: Any) -> None:
        content = self._dump(data)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(content).digest() + content)

    def _read(self, path: str) -> Any:
        content = Path(path).read_bytes()
        digest, content = content[:DIGEST], content[DIGEST:]
        if hashlib.sha256(content).digest() != digest:
            raise ValueError(f"{path} is damaged")
        return pickle.loads(content)


class _OurPlace(_caching.CompileResultCacheImpl):  # type: ignore[misc]
    _locator_classes = (_caching.UserProvidedCacheLocator,)


class KernelCache(_caching.FunctionCache):  # type: ignore[misc]
    """numba's cache of one kernel, where whatever fails is as if nothing were kept."""

    _impl_class = _OurPlace
    damage_found: ClassVar[Callable[[], None]] = staticmethod(lambda: None)
    """Called where something that is kept is damaged, before it is made anew."""

    def __init__(self, function: Any, ending: str) -> None:
        """A cache in the folder that numba is configured to use; names of its files have this ending."""
        super().__init__(function)
        self._cache_file = _CheckedFiles(
            cache_path=self._cache_path,
            filename_base=self._impl.filename_base + ending,
            source_stamp=self._impl.locator.get_source_stamp(),
        )

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code for a signature, None where there is none that is whole."""
        try:
            return super().load_overload(sig, target_context)
        except OSError:
            return None
        except Exception:  # what a damaged file leads to
            KernelCache.damage_found()
            with contextlib.suppress(OSError):
                self.flush()
            return None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the machine code for a signature, if that can be."""
        with contextlib.suppress(OSError, ValueError):
            super().save_overload(sig, data)


class CacheByCode(_caching.NullCache):  # type: ignore[misc]
    """The caches of one kernel, one a folder: whose code its machine code holds is known only as it is compiled."""

    def __init__(self, function: Any, ending: str, folder_of: Callable[[Any], Path | None]) -> None:
        """For a kernel whose machine code for some types belongs in the folder that `folder_of` them says."""
        self._function, self._ending, self._folder_of = function, ending, folder_of
        self._caches: dict[Path | None, Any] = {None: _caching.NullCache()}

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The machine code for a signature, None where there is none that is whole."""
        return self._cache(sig).load_overload(sig, target_context)

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the machine code for a signature, if that can be."""
        self._cache(sig).save_overload(sig, data)

    def _cache(self, sig: Any) -> Any:
        folder = self._folder_of(_signatures.normalize_signature(sig)[0])
        if folder is not None and folder not in self._caches:
            self._caches[folder] = _cache_in(folder, self._function, self._ending)
        return self._caches[folder]


def _cache_in(folder: Path, function: Any, ending: str) -> Any:
    """The cache of a kernel in a folder; one that keeps nothing if that fails."""
    before = _settings.CACHE_DIR
    _settings.CACHE_DIR = str(folder)  # while it is made: other people's kernels keep their own place
    try:
        return KernelCache(function, ending)
    except (OSError, RuntimeError):
        return _caching.NullCache()
    finally:
        _settings.CACHE_DIR = before
