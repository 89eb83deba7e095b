"""A frame of a stream: bytes → its header's fields, its JPEG, its small picture of depth (PROTOCOL.md, "Frames"). Pure."""
from __future__ import annotations

import math
import struct
import zlib
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, List, Optional

from .errors import BadAnswer
from .picture import Picture, numpy_for

if TYPE_CHECKING:
    import numpy
    import PIL.Image

HEADER = struct.Struct("<4sHHBBHIQQIIII")
DEPTH = struct.Struct("<HHIff")
_MOST_CELLS = 160
_MOST_SIDE = 16384
_MANTISSA = 9
_NEAREST = 8192
_UNIT = 2.0 ** 24


@dataclass(frozen=True)
class DepthCells:
    """The depth of a frame in cells, packed."""

    width: int
    height: int
    near: float
    far: float
    packed: bytes = field(repr=False)

    def inverse(self) -> List[float]:
        """1 / depth of each cell, row by row from the top, in 1 / the cloud's unit; 0 is background. BadAnswer for bytes that mean nothing."""
        count = self.width * self.height
        unpacker = zlib.decompressobj()
        try:
            symbols = unpacker.decompress(self.packed, 2 * count + 1)  # never more than there are
            ended = unpacker.eof and not unpacker.unused_data
        except zlib.error as error:
            raise BadAnswer(f"the depth of a frame is no zlib stream: {error}") from None
        if len(symbols) != 2 * count or not ended:
            raise BadAnswer(f"the depth of a frame does not unpack to the {2 * count} bytes of its cells")
        codes = [0] * count
        found = [0.0] * count
        for i in range(count):
            first = i % self.width == 0
            if i < self.width:
                code = 0 if first else codes[i - 1]
            elif first:
                code = codes[i - self.width]
            else:
                left, above = codes[i - 1], codes[i - self.width]
                low, high = (left, above) if left < above else (above, left)
                code = max(low, min(high, left + above - codes[i - self.width - 1]))
            symbol = symbols[i] + 256 * symbols[count + i]
            if symbol:
                code += (symbol - 1) // 2 if symbol % 2 else -(symbol // 2)
                if not (1 <= code <= _NEAREST and self.near > 0):
                    raise BadAnswer("a cell of the frame's depth lies nearer than its nearest, or nowhere")
                octave = max(0, (code >> _MANTISSA) - 1)
                found[i] = (code - (octave << _MANTISSA)) * 2.0 ** octave / _UNIT / self.near
            codes[i] = code
        return found

    def array(self) -> "numpy.ndarray[Any, Any]":
        """Depth: float32 of shape (height, width), in the cloud's unit along the view direction, +infinity where nothing is."""
        numpy = numpy_for("depth as an array")
        inverse = numpy.array(self.inverse()).reshape(self.height, self.width)
        with numpy.errstate(divide="ignore"):
            return (1.0 / inverse).astype(numpy.float32)  # type: ignore[no-any-return]


@dataclass(frozen=True)
class Frame:
    """A picture of a live view. A notebook shows it."""

    id: int
    """Counts the session's frames from 1."""
    seq: int
    """Of the view that it shows: what ``LiveView.view`` returned; 0 before the first."""
    width: int
    height: int
    moving: bool
    still: bool
    final: bool
    """Full quality: nothing follows until something changes."""
    damaged: bool
    """Blocks of the cloud cannot be read; coarser points are drawn in their place."""
    away: bool
    """Coarser than it would be, because a part of the server is away."""
    render_seconds: float
    encode_seconds: float
    jpeg: bytes = field(repr=False)
    depth: Optional[DepthCells] = None
    """Where the view was opened with ``depth=True``."""

    def image(self) -> "PIL.Image.Image":
        """For Pillow."""
        return Picture(self.jpeg, "image/jpeg").image()

    def array(self) -> "numpy.ndarray[Any, Any]":
        """uint8 of shape (height, width, 3), rows from the top."""
        return Picture(self.jpeg, "image/jpeg").array()

    def _repr_jpeg_(self) -> bytes:
        return self.jpeg


def parse_frame(data: bytes) -> Frame:
    """One binary message. BadAnswer for what is no frame."""
    if len(data) < HEADER.size:
        raise BadAnswer("a frame ends before its header does")
    magic, version, head, codec, flags, _, size, number, seq, width, height, render, encode = HEADER.unpack_from(data)
    if magic != b"SCFR" or version != 1:
        raise BadAnswer("a frame is not of a kind that this client knows")
    if head < HEADER.size or head > len(data) or len(data) - head != size:
        raise BadAnswer(f"a frame of {len(data)} bytes cannot have a header of {head} and a picture of {size}")
    if codec != 1:
        raise BadAnswer(f"a frame's picture is in an unknown codec, {codec}")
    if not (1 <= width <= _MOST_SIDE and 1 <= height <= _MOST_SIDE):
        raise BadAnswer(f"a frame cannot have {width} x {height} pixels")
    return Frame(number, seq, width, height, bool(flags & 1), bool(flags & 2), bool(flags & 4), bool(flags & 8), bool(flags & 16),
                 render / 1e6, encode / 1e6, data[head:], _depth_of(data, head))


def _depth_of(data: bytes, head: int) -> Optional[DepthCells]:
    begin = HEADER.size + DEPTH.size
    if head < begin:
        return None
    width, height, size, near, far = DEPTH.unpack_from(data, HEADER.size)
    if size == 0:
        return None
    if not (1 <= width <= _MOST_CELLS and 1 <= height <= _MOST_CELLS) or size > head - begin:
        raise BadAnswer(f"a frame's depth of {width} x {height} cells in {size} bytes is none")
    if not (near == far == 0) and not (0 < near <= far and math.isfinite(far)):
        raise BadAnswer("a frame's depth has no range that there can be")
    return DepthCells(width, height, near, far, data[begin:begin + size])
