"""Reading the flat Parquet that visitlab writes (numbers, no nulls, Snappy), each length checked before it is used.

pyarrow's own reader takes a file's word for sizes and can crash on a crafted one; a table of trials is little enough to
be decoded here. Of pyarrow only the unpacking of Snappy is used.
"""

from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from visitlab_cli.storage.thrift import Thrift

Columns = dict[str, npt.NDArray[Any]]
_MAGIC = b"PAR1"
_SHORTEST = 12
_TYPES = {1: "<i4", 5: "<f8"}
"""Parquet's number of a type, and numpy's name."""
_UNCOMPRESSED, _SNAPPY = 0, 1
_PLAIN, _PLAIN_DICTIONARY, _RLE, _RLE_DICTIONARY = 0, 2, 3, 8
_DATA_PAGE, _DICTIONARY_PAGE = 0, 2
MOST_FOOTER = 1 << 20
MOST_PAGE = 8 << 20
"""Bytes of a page when unpacked; ours have about 1 MB."""
MOST_HEADER = 1 << 12
MOST_BITS = 24


class _Chunk(NamedTuple):
    """A column's part in a group of rows: where its pages lie, how they are packed, its values and their type."""

    data: bytes
    begin: int
    end: int
    codec: int
    rows: int
    dtype: str
    optional: bool


def decode(
    data: bytes, expected: Mapping[str, str], optional: Collection[str] = (), rows: int | None = None
) -> Columns:
    """The columns of a Parquet file, which are those expected.

    Args:
        data: the file.
        expected: the dtype of each column by its name, in their order; `<i4` or `<f8`.
        optional: those that may be missing.
        rows: how many there must be, where that is known.

    Raises:
        ValueError: it is not such a file; one line.
    """
    try:
        return _decode(data, expected, optional, rows)
    except (IndexError, KeyError, TypeError, AttributeError, OverflowError) as error:
        raise ValueError("its description is damaged") from error


def _decode(data: bytes, expected: Mapping[str, str], optional: Collection[str], wanted: int | None) -> Columns:
    if len(data) < _SHORTEST or data[:4] != _MAGIC or data[-4:] != _MAGIC:
        raise ValueError("no Parquet, or cut short")
    length = int.from_bytes(data[-8:-4], "little")
    if length > min(MOST_FOOTER, len(data) - _SHORTEST):
        raise ValueError("its footer is longer than it can be")
    footer = len(data) - 8 - length
    about = Thrift(data[footer:-8]).struct()
    root, *leaves = about[2]
    names = [leaf[4].decode("utf-8") for leaf in leaves]
    columns = {name: dtype for name, dtype in expected.items() if name in names or name not in optional}
    if names != list(columns) or root[5] != len(leaves) or any(5 in leaf for leaf in leaves):
        raise ValueError(f"has other columns than {', '.join(columns)}")
    if [_TYPES.get(leaf[1]) for leaf in leaves] != list(columns.values()) or any(
        leaf[3] not in (0, 1) for leaf in leaves
    ):
        raise ValueError("has columns of other types")
    rows, groups = about[3], about[4]
    # the numbers of the trials alone take more than a byte a row
    if not 0 < rows <= len(data) or sum(group[3] for group in groups) != rows or any(group[3] < 1 for group in groups):
        raise ValueError(f"claims {rows:,} rows in {len(data):,} bytes")
    if wanted is not None and rows != wanted:
        raise ValueError(f"has {rows:,} rows, not {wanted:,}")
    found: Columns = {}
    for place, (name, dtype) in enumerate(columns.items()):
        column, done = np.empty(rows, dtype), 0
        for group in groups:
            if len(group[1]) != len(columns):
                raise ValueError("a group of rows has other columns")
            chunk = _chunk(data, footer, group[1][place][3], group[3], dtype, leaves[place][3] == 1)
            column[done : done + chunk.rows] = _values(chunk)
            done += chunk.rows
        found[name] = column
    return found


def _chunk(data: bytes, footer: int, about: dict[int, Any], rows: int, dtype: str, optional: bool) -> _Chunk:
    begin = min(about[9], about.get(11, about[9]))
    end = begin + about[7]
    if about[5] != rows or not len(_MAGIC) <= begin < end <= footer:
        raise ValueError("a column lies outside of the file")
    if about[4] not in (_UNCOMPRESSED, _SNAPPY):
        raise ValueError("packed in another way than visitlab does")
    return _Chunk(data, begin, end, about[4], rows, dtype, optional)


def _values(chunk: _Chunk) -> npt.NDArray[Any]:
    """The values of a chunk, shape (rows,)."""
    parts: list[npt.NDArray[Any]] = []
    dictionary: npt.NDArray[Any] | None = None
    place, done = chunk.begin, 0
    while done < chunk.rows:
        thrift = Thrift(chunk.data[place : min(chunk.end, place + MOST_HEADER)])
        header = thrift.struct()
        place += thrift.place
        packed, unpacked = header[3], header[2]
        if not 0 <= packed <= chunk.end - place or not 0 <= unpacked <= MOST_PAGE:
            raise ValueError("a page is larger than it can be")
        content = _unpacked(chunk.data[place : place + packed], unpacked, chunk.codec)
        place += packed
        if header[1] == _DICTIONARY_PAGE and dictionary is None and not parts:
            if header[7][2] not in (_PLAIN, _PLAIN_DICTIONARY):
                raise ValueError("a dictionary of another kind than visitlab writes")
            dictionary = _plain(content, header[7][1], chunk.dtype)
        elif header[1] == _DATA_PAGE:
            count = header[5][1]
            if not 0 < count <= chunk.rows - done:
                raise ValueError("has pages of more values than rows")
            parts.append(_page(content, count, header[5], dictionary, chunk))
            done += count
        else:
            raise ValueError("has a page of another kind than visitlab writes")
    return np.concatenate(parts)


def _unpacked(packed: bytes, size: int, codec: int) -> bytes:
    stated = len(packed) if codec == _UNCOMPRESSED else Thrift(packed).varint()
    if stated != size:  # else what is left of the buffer would be anything
        raise ValueError("a page has another length than it says")
    if codec == _UNCOMPRESSED:
        return packed
    import pyarrow

    try:
        return bytes(pyarrow.decompress(packed, decompressed_size=size, codec="snappy", asbytes=True))
    except (OSError, pyarrow.ArrowException) as error:
        raise ValueError("a page can't be unpacked") from error


def _plain(content: bytes, count: int, dtype: str) -> npt.NDArray[Any]:
    if count < 0 or len(content) != count * np.dtype(dtype).itemsize:
        raise ValueError("a page has not the bytes of its values")
    return np.frombuffer(content, dtype)


def _page(
    content: bytes, count: int, about: dict[int, Any], dictionary: npt.NDArray[Any] | None, chunk: _Chunk
) -> npt.NDArray[Any]:
    if chunk.optional:
        length = int.from_bytes(content[:4], "little")
        if about[3] != _RLE or length > len(content) - 4 or not _hybrid(content[4 : 4 + length], 1, count).all():
            raise ValueError("has missing values")
        content = content[4 + length :]
    if about[2] == _PLAIN:
        return _plain(content, count, chunk.dtype)
    if about[2] not in (_PLAIN_DICTIONARY, _RLE_DICTIONARY) or dictionary is None:
        raise ValueError("has values in another form than visitlab writes")
    if not content or content[0] > MOST_BITS:
        raise ValueError("has a dictionary that is too large")
    index = _hybrid(content[1:], content[0], count)
    if not len(dictionary) or index.max() >= len(dictionary):
        raise ValueError("has a value outside of its dictionary")
    return dictionary[index]


def _hybrid(content: bytes, width: int, count: int) -> npt.NDArray[np.int64]:
    """`count` numbers of `width` bits in runs: repeated ones, and groups of eight packed one behind the other."""
    thrift = Thrift(content)
    size = (width + 7) // 8
    lengths: list[int] = []
    firsts: list[int] = []  # the repeated value, or -1
    packed: list[bytes] = []
    left = count
    while left > 0:
        head = thrift.varint()
        run = (head >> 1) * 8 if head & 1 else head >> 1
        end = thrift.place + ((head >> 1) * width if head & 1 else size)
        if not 0 < run < left + 8 or (run > left and not head & 1) or end > len(content):
            raise ValueError("a run that is longer than its page")
        part = content[thrift.place : end]
        if head & 1:
            packed.append(part)
        firsts.append(-1 if head & 1 else int.from_bytes(part, "little"))
        lengths.append(run)
        thrift.place = end
        left -= run
    numbers = np.repeat(np.array(firsts, np.int64), lengths)
    numbers[numbers < 0] = _unpacked_bits(b"".join(packed), width, int((numbers < 0).sum()))
    return numbers[:count]


def _unpacked_bits(content: bytes, width: int, count: int) -> npt.NDArray[np.int64]:
    numbers = np.zeros(count, np.int64)
    bits = np.unpackbits(np.frombuffer(content, np.uint8), bitorder="little").reshape(count, width)
    for place in range(width):  # one after another: a product of matrices would take eight times the memory
        numbers |= bits[:, place].astype(np.int64) << place
    return numbers
