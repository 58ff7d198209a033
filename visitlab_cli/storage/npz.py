"""Reading an `.npz` as visitlab writes it: sizes are checked before anything is unpacked, and nothing is executed."""

import re
import struct
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from visitlab_cli.agents.declared import (
    DTYPES,
    MOST_ARRAYS,
    MOST_BYTES,
    NAME,
    Declared,
    fault_in_form,
    fault_in_values,
)
from visitlab_cli.storage.reading import MOST_TABLE, open_file

Arrays = dict[str, npt.NDArray[Any]]

_LAST_RECORD = struct.Struct("<4s4H2LH")
_LOCATOR = 20
"""Bytes of the record that leads to a larger list, which no model needs."""
_ENTRY = 46 + 200
"""Bytes of a member in the list of members, with a name and extra fields."""
_HEADER = re.compile(
    rb"\{'descr': '([<|][a-z]\d)', 'fortran_order': False, 'shape': \(((?:\d{1,10}, ?)*(?:\d{1,10})?)\), ?\} *\n"
)
_LONGEST_HEADER = 512
_MAGIC = b"\x93NUMPY\x01\x00"
_PART = 1 << 20
_DAMAGE = (ValueError, EOFError, KeyError, IndexError, RuntimeError, struct.error, zlib.error, zipfile.BadZipFile)


class NotAModelError(ValueError):
    """An archive of something else."""


def read_npz(file: Path, declared: Mapping[str, Declared] | None) -> Arrays:
    """The arrays by name: those that are `declared`, or all that have numbers.

    Raises:
        OSError: there is no such file, or it can't be read.
        ValueError: it is not as visitlab writes one, or not as declared; one line.
    """
    with open_file(file) as stream:
        _check_list(stream)
        try:
            with zipfile.ZipFile(stream) as archive:
                return _arrays(archive, declared)
        except NotAModelError:
            raise
        except _DAMAGE as error:
            raise ValueError(ascii(str(error) or type(error).__name__)[1:-1]) from error


def _check_list(stream: IO[bytes]) -> None:
    """That the list of members is short and at the file's end, before anything else looks for it."""
    size = stream.seek(0, 2)
    if size > MOST_TABLE:
        raise ValueError(f"has more than {MOST_TABLE:,} bytes")
    if size < _LAST_RECORD.size:
        raise ValueError("no archive, it is cut short" if size else "empty")
    stream.seek(max(0, size - _LAST_RECORD.size - _LOCATOR))
    end = stream.read(_LAST_RECORD.size + _LOCATOR)
    magic, _, _, here, count, length, start, comment = _LAST_RECORD.unpack(end[-_LAST_RECORD.size :])
    if magic != b"PK\x05\x06" or comment or end.startswith(b"PK\x06\x07"):
        raise ValueError("File is not a zip file")
    if here != count or count > MOST_ARRAYS or length > count * _ENTRY:
        raise ValueError(f"claims {count} arrays in a list of {length:,} bytes")
    if start + length + _LAST_RECORD.size != size:
        raise ValueError("no archive of arrays, or with something before or behind it")
    stream.seek(0)


def _arrays(archive: zipfile.ZipFile, declared: Mapping[str, Declared] | None) -> Arrays:
    members = archive.infolist()
    names = [member.filename for member in members]
    if len(set(names)) != len(names) or any(not _is_of_an_array(name) for name in names):
        raise NotAModelError(f"not a model: {', '.join(ascii(name)[1:-1] for name in names)[:200]}")
    there = {member.filename.removesuffix(".npy"): member for member in members}
    if lacking := [name for name in declared or () if name not in there]:
        raise ValueError(f"has no array {lacking[0]}")
    left = MOST_BYTES
    found: Arrays = {}
    for name in there if declared is None else declared:
        member = there[name]
        left -= member.file_size
        if left < 0:
            raise ValueError(f"claims arrays of more than {MOST_BYTES:,} bytes")
        if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED) or member.flag_bits & 1:
            raise ValueError(f"{name} is packed in another way than visitlab does")
        with archive.open(member) as content:
            try:
                found[name] = _array(content, member.file_size, None if declared is None else declared[name])
            except ValueError as error:
                raise ValueError(f"{name} {error}") from error
    return found


def _is_of_an_array(member: str) -> bool:
    return member.endswith(".npy") and NAME.fullmatch(member.removesuffix(".npy")) is not None


def _array(content: IO[bytes], size: int, declared: Declared | None) -> npt.NDArray[Any]:
    """One array; its header says how many bytes follow, and so many there are, and no more are unpacked."""
    begin = content.read(len(_MAGIC) + 2)
    if len(begin) != len(_MAGIC) + 2 or not begin.startswith(_MAGIC):
        raise ValueError("is no array")
    length = int.from_bytes(begin[-2:], "little")
    header = _HEADER.fullmatch(content.read(length)) if length <= _LONGEST_HEADER else None
    if header is None or header[1].decode() not in DTYPES:
        raise ValueError("is no array of numbers as visitlab writes one")
    dtype, shape = header[1].decode(), tuple(int(part) for part in header[2].split(b",") if part.strip())
    if declared is not None and (fault := fault_in_form(declared, dtype, shape)):
        raise ValueError(fault)
    total = np.dtype(dtype).itemsize
    for extent in shape:
        total *= extent
    if len(begin) + length + total != size:
        raise ValueError(f"has not the bytes of {dtype} of shape {shape}")
    data = bytearray(total)
    done = 0
    while done < total:
        part = content.read(min(total - done, _PART))
        if not part:
            raise ValueError("is cut short")
        data[done : done + len(part)] = part
        done += len(part)
    if content.read(1):  # reads to the end, where the archive's sum is compared
        raise ValueError("has more bytes than its shape")
    array = np.frombuffer(data, dtype).reshape(shape)
    if declared is not None and (fault := fault_in_values(declared, array)):
        raise ValueError(fault)
    return array
