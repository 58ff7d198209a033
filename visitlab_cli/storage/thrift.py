"""The compact protocol of Thrift, in which Parquet describes itself, read into plain values within bounds."""

from typing import Any

MOST_VALUES = 20_000
DEEPEST = 12
_LONG = 15  # a list of so many or more says its length apart
_TRUE, _FALSE, _BYTE, _I16, _I32, _I64, _DOUBLE, _BINARY, _LIST, _SET, _MAP, _STRUCT = range(1, 13)


class Thrift:
    """Reads structs from bytes: each a dict of its fields by number.

    Raises:
        ValueError, IndexError: from every method, where there is no such thing.
    """

    def __init__(self, data: bytes) -> None:
        """Begin with the first byte."""
        self.data, self.place, self.values = data, 0, 0

    def varint(self) -> int:
        """A number of 0 or more."""
        number = shift = 0
        while True:
            byte = self.data[self.place]
            self.place += 1
            number |= (byte & 0x7F) << shift
            if byte < 0x80:
                return number
            shift += 7
            if shift > 63:
                raise ValueError("a number that is too long")

    def _whole(self) -> int:
        number = self.varint()
        return number >> 1 ^ -(number & 1)

    def struct(self, deep: int = DEEPEST) -> dict[int, Any]:
        """The fields of a struct."""
        if not deep:
            raise ValueError("nested too deep")
        fields: dict[int, Any] = {}
        number = 0
        while True:
            head = self.data[self.place]
            self.place += 1
            if not head:
                return fields
            kind, step = head & 0x0F, head >> 4
            number = number + step if step else self._whole()
            if number in fields:
                raise ValueError("a field twice")
            fields[number] = kind == _TRUE if kind in (_TRUE, _FALSE) else self._value(kind, deep)

    def _value(self, kind: int, deep: int) -> Any:
        self.values += 1
        if self.values > MOST_VALUES:
            raise ValueError("too many values")
        if kind in (_TRUE, _FALSE, _BYTE):  # a truth within a list takes a byte
            return self._bytes(1)[0]
        if kind in (_I16, _I32, _I64):
            return self._whole()
        if kind == _DOUBLE:
            return self._bytes(8)
        if kind == _BINARY:
            return self._bytes(self.varint())
        if kind in (_LIST, _SET):
            return self._list(deep - 1)
        if kind == _STRUCT:
            return self.struct(deep - 1)
        raise ValueError(f"a value of kind {kind}")

    def _list(self, deep: int) -> list[Any]:
        if not deep:
            raise ValueError("nested too deep")
        head = self._bytes(1)[0]
        length = head >> 4 if head >> 4 < _LONG else self.varint()
        if length > MOST_VALUES - self.values:
            raise ValueError("too many values")
        return [self._value(head & 0x0F, deep) for _ in range(length)]

    def _bytes(self, length: int) -> bytes:
        part = self.data[self.place : self.place + length]
        if len(part) != length:
            raise ValueError("cut short")
        self.place += length
        return part
