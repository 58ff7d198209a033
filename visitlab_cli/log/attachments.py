"""An attachment by its parts: its data, which may be large, is only read where it is asked for."""

import struct
from typing import NamedTuple

from visitlab_cli.log.source import PREFIX, DamagedError, McapSource, Place

MOST_HEAD = 1 << 16
"""So many bytes hold the times, name and media type of an attachment."""
_TIMES, _LETTERS, _LENGTH, _CRC = struct.Struct("<QQ"), struct.Struct("<I"), struct.Struct("<Q"), struct.Struct("<I")
CRC_SIZE = _CRC.size


class Attached(NamedTuple):
    """What an attachment says of itself; its data are the file's bytes from `start` up to `end`."""

    log_time: int
    create_time: int
    name: str
    media_type: str
    start: int
    end: int


def attached(source: McapSource, place: Place) -> Attached:
    """The attachment at a place.

    Raises:
        DamagedError: its bytes are none, or its CRC, where it has one, is wrong.
    """
    first = place.start + PREFIX.size
    head = source.read(first, min(place.end, first + MOST_HEAD))
    try:
        log_time, create_time = _TIMES.unpack_from(head)
        name, position = _text(head, _TIMES.size)
        media_type, position = _text(head, position)
        (length,) = _LENGTH.unpack_from(head, position)
    except (struct.error, ValueError) as error:
        raise _damaged(place) from error
    start = first + position + _LENGTH.size
    end = start + length
    if end + _CRC.size > place.end:
        raise _damaged(place)
    (crc,) = _CRC.unpack(source.read(end, end + _CRC.size))
    if crc and crc != source.crc(first, end):
        raise _damaged(place)
    return Attached(log_time, create_time, name, media_type, start, end)


def _text(head: bytes, position: int) -> tuple[str, int]:
    (length,) = _LETTERS.unpack_from(head, position)
    start = position + _LETTERS.size
    if start + length > len(head):
        raise ValueError("cut")
    return head[start : start + length].decode(), start + length


def _damaged(place: Place) -> DamagedError:
    return DamagedError(f"the Attachment at byte {place.start:,} is damaged")
