"""A cloud in plan: elevations and orthophotos, as arrays or as GeoTIFF. What `Cloud` is made of, beside pictures and points."""
from __future__ import annotations

import json
import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple

from . import errors, words
from ._http import Body, Transport
from ._values import as_float, number_text, plain
from .picture import Path, whole_file

if TYPE_CHECKING:
    import numpy
    from typing_extensions import Unpack

    from ._view_words import ViewWords

    Array = numpy.ndarray[Any, Any]

_PIECE = 1 << 20
_MOST_BYTES = 1 << 34
_NO_ELEVATION = -3.4028234663852886e+38
_WIDTH, _HEIGHT, _BITS, _SAMPLES, _TILE, _OFFSETS, _FORMAT = 256, 257, 258, 277, 322, 324, 339
_SIZES = {1: "B", 2: "c", 3: "H", 4: "I", 12: "d", 16: "Q"}


@dataclass(frozen=True)
class Raster:
    """Cells in plan, the first row in the north: ``left`` and ``top`` are the outer corner of the first one, in file coordinates."""

    bytes: bytes = field(repr=False)
    """The GeoTIFF."""
    columns: int
    rows: int
    cell: float
    left: float
    top: float

    @property
    def bounds(self) -> Tuple[float, float, float, float]:
        """Least x and y, most x and y."""
        return self.left, self.top - self.rows * self.cell, self.left + self.columns * self.cell, self.top

    def array(self) -> "Array":
        """Elevations as float64 of shape (rows, columns), NaN where nothing is; counts as uint32; an orthophoto as uint8, (rows, columns, 4)."""
        return _cells_of(self.bytes, self.rows, self.columns)

    def save(self, path: Path) -> None:
        with whole_file(path) as file:
            file.write(self.bytes)


def _tags_of(data: bytes) -> Dict[int, Any]:
    """The tags of the first directory of a TIFF as this server writes them."""
    big = data[:4] == b"II\x2b\0"
    if not big and data[:4] != b"II\x2a\0":
        raise errors.BadAnswer("this raster is no TIFF of a Scancast server")
    at, = struct.unpack_from("<Q" if big else "<I", data, 8 if big else 4)
    count, = struct.unpack_from("<Q" if big else "<H", data, at)
    at += 8 if big else 2
    tags: Dict[int, Any] = {}
    for _ in range(count):
        tag, kind, number = struct.unpack_from("<HHQ" if big else "<HHI", data, at)
        letter = _SIZES.get(kind)
        if letter:
            size, place = number * struct.calcsize(letter), at + (12 if big else 8)
            if size > (8 if big else 4):
                place, = struct.unpack_from("<Q" if big else "<I", data, place)
            tags[tag] = struct.unpack_from(f"<{number}{letter}", data, place) if tag in (_WIDTH, _HEIGHT, _BITS, _SAMPLES, _TILE, _OFFSETS, _FORMAT) else ()
        at += 20 if big else 12
    return tags


def _cells_of(data: bytes, rows: int, columns: int) -> "Array":
    try:
        import numpy
    except ImportError:
        raise errors.MissingLibrary("arrays need NumPy: pip install numpy") from None
    try:
        tags = _tags_of(data)
        side, color = tags[_TILE][0], tags[_SAMPLES][0] == 4
        kind = numpy.dtype(numpy.uint8 if color else numpy.dtype("<f4") if tags[_FORMAT][0] == 3 else numpy.dtype("<u4"))
        if (tags[_WIDTH][0], tags[_HEIGHT][0]) != (columns, rows):
            raise errors.BadAnswer("this raster has another size than the server said")
        across, shape = -(-columns // side), (side, side) + ((4,) if color else ())
        cells = numpy.empty((rows, columns) + shape[2:], kind)
        for index, offset in enumerate(tags[_OFFSETS]):
            tile = numpy.frombuffer(data, kind, side * side * (4 if color else 1), offset).reshape(shape)
            top, left = index // across * side, index % across * side
            part = cells[top:top + side, left:left + side]
            part[...] = tile[:part.shape[0], :part.shape[1]]
    except (struct.error, KeyError, IndexError, ValueError):
        raise errors.BadAnswer("this raster is no TIFF of a Scancast server") from None
    if color or kind == numpy.dtype("<u4"):
        return cells
    found = cells.astype(numpy.float64)
    found[cells == numpy.float32(_NO_ELEVATION)] = numpy.nan
    return found


class RastersOfCloud:
    """What a cloud says of itself in plan."""

    _transport: Transport

    def _path(self, what: str) -> str:
        raise NotImplementedError

    def _asked_raster(self, what: str, own: Mapping[str, Any], given: Mapping[str, Any]) -> str:
        pairs: List[Tuple[str, str]] = []
        for name, value in own.items():
            if value is None:
                continue
            told = plain(value, name)
            pairs.append((name, ",".join(number_text(one) for one in told) if isinstance(told, list) else
                          told if isinstance(told, str) else number_text(told)))
        pairs += words.words_text(words.view_of(given))
        spoken = words.query(pairs)
        return self._path(what) + (f"?{spoken}" if spoken else "")

    def _raster(self, what: str, own: Mapping[str, Any], given: Mapping[str, Any]) -> Raster:
        # Not packed, it comes while it is made: nothing waits for the first byte.
        path = self._asked_raster(what, {**own, "compress": "none"}, given)
        with self._transport.stream("GET", path, None, "image/tiff") as body:
            data = bytearray()
            while True:
                piece = body.read(_PIECE)
                if not piece:
                    break
                data += piece
                if len(data) > _MOST_BYTES:
                    raise errors.BadAnswer(f"{self._transport.address.authority} answers with more than {_MOST_BYTES} bytes")
            return _placed(body, bytes(data))

    def _save_raster(self, path: Path, what: str, own: Mapping[str, Any], given: Mapping[str, Any]) -> None:
        with whole_file(path) as file, self._transport.stream("GET", self._asked_raster(what, own, given), None, "image/tiff") as body:
            while True:
                piece = body.read(_PIECE)
                if not piece:
                    break
                file.write(piece)

    def dem(self, *, bbox: Optional[Tuple[float, float, float, float]] = None, cell: Optional[float] = None, value: str = "highest",
            fill: int = 0, **points: "Unpack[ViewWords]") -> Raster:
        """Elevations in plan: of every cell the ``highest``, the ``lowest`` or the ``mean`` of the scan's points, or their ``count``. `bbox`: least x and y,
        most x and y; `cell`: their side; `fill`: holes are closed from what is around them within so many cells. Words of a view say which points count.

        >>> heights = cloud.dem(cell=0.5, classes=[2], value="mean").array()   # doctest: +SKIP
        """
        return self._raster("dem.tif", {"bbox": bbox, "cell": cell, "value": value, "fill": fill}, points)

    def save_dem(self, path: Path, *, bbox: Optional[Tuple[float, float, float, float]] = None, cell: Optional[float] = None,
                 value: str = "highest", fill: int = 0, compress: str = "none", **points: "Unpack[ViewWords]") -> None:
        """The same as a GeoTIFF, of any size. `compress`: ``deflate`` makes it smaller, and begins to come when all of it is made: give the server a
        `timeout` for that."""
        own = {"bbox": bbox, "cell": cell, "value": value, "fill": fill, "compress": compress}
        self._save_raster(path, "dem.tif", own, points)

    def ortho(self, *, bbox: Optional[Tuple[float, float, float, float]] = None, cell: Optional[float] = None, **given: "Unpack[ViewWords]") -> Raster:
        """An orthophoto: the cloud from straight above, a pixel a cell, drawn as words of a view say; transparent where nothing is."""
        return self._raster("ortho.tif", {"bbox": bbox, "cell": cell}, given)

    def save_ortho(self, path: Path, *, bbox: Optional[Tuple[float, float, float, float]] = None, cell: Optional[float] = None,
                   compress: str = "none", **given: "Unpack[ViewWords]") -> None:
        """The same as a GeoTIFF, of any size."""
        self._save_raster(path, "ortho.tif", {"bbox": bbox, "cell": cell, "compress": compress}, given)


def _placed(body: Body, data: bytes) -> Raster:
    try:
        told = json.loads(body.headers.text("Scancast-Raster"))
        return Raster(data, int(told["columns"]), int(told["rows"]), as_float(told["cell"]), as_float(told["left"]), as_float(told["top"]))
    except (ValueError, KeyError, TypeError, RecursionError):
        raise errors.BadAnswer("the server's answer is not as the protocol has it: Scancast-Raster says not where it lies") from None
