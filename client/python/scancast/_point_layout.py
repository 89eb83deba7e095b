"""What readers of points share: bytes in the pieces that are asked for, and what a head says."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Callable, List, NamedTuple, Tuple

from .errors import BadAnswer

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]

Read = Callable[[int], bytes]
"""Up to so many bytes; b"" at the end."""


class Source:
    """Bytes in pieces of the sizes that are asked for."""

    def __init__(self, read: Read) -> None:
        self._read = read
        self._kept = b""

    def some(self, size: int) -> bytes:
        if self._kept:
            data, self._kept = self._kept[:size], self._kept[size:]
            return data
        return self._read(size)

    def exactly(self, size: int, what: str) -> bytes:
        data = self.up_to(size)
        if len(data) < size:
            raise BadAnswer(f"{what} end early: {len(data)} bytes of {size}")
        return data

    def up_to(self, size: int) -> bytes:
        """Fewer at the end only."""
        parts: List[bytes] = []
        left = size
        while left > 0:
            part = self.some(min(left, 1 << 20))
            if not part:
                break
            parts.append(part)
            left -= len(part)
        return parts[0] if len(parts) == 1 else b"".join(parts)

    def until(self, end: bytes, limit: int, what: str) -> bytes:
        data = bytearray()
        while True:
            at = data.find(end, max(0, len(data) - (1 << 20) - len(end)))
            if at >= 0:
                self._kept = bytes(data[at + len(end):]) + self._kept
                return bytes(data[:at])
            if len(data) > limit:
                raise BadAnswer(f"{what} has more than {limit} bytes")
            part = self.some(8192)
            if not part:
                raise BadAnswer(f"{what} ends early")
            data += part


class Layout(NamedTuple):
    """What a head says."""

    points: int
    record_bytes: int
    dtype: "numpy.dtype[Any]"
    """Of the arrays."""
    decode: "Callable[[bytes], Array]"
    """Whole records → an array of that dtype."""
    crs: str
    """The coordinate reference system: WKT, or its name; empty where nothing is said."""


def number_of(text: str, what: str) -> int:
    if not (text.isascii() and text.isdigit()) or len(text) > 19:
        raise BadAnswer(f"{what} is no number")
    return int(text)


def dtype_of(numpy: Any, fields: List[Tuple[Any, ...]]) -> Any:
    """Of named fields; one name twice is told apart by a number."""
    seen = set()
    named: List[Tuple[Any, ...]] = []
    for name, *kind in fields:
        name = usual = name or "field"
        number = 1
        while name in seen:
            number += 1
            name = f"{usual}_{number}"
        seen.add(name)
        named.append((name, *kind))
    return numpy.dtype(named)
