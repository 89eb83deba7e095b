"""Points as a server sends them - binary PLY or LAS - → structured NumPy arrays, as they come.

Nothing is allocated because a head says so: arrays grow with the points that arrive, and what ends early or says what cannot be is a BadAnswer.
"""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Iterator

from ._las import las_layout
from ._ply import ply_layout
from ._point_layout import Read, Source
from .errors import BadAnswer
from .picture import numpy_for

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]

_CHUNK_BYTES = 4 << 20
_FIRST_POINTS = 1 << 16


class PointReader:
    """Reads a head at once, and points as they are asked for."""

    def __init__(self, read: Read) -> None:
        """BadAnswer for what is neither PLY nor LAS; MissingLibrary without NumPy."""
        numpy = numpy_for("points as an array")
        self._source = Source(read)
        begin = self._source.exactly(4, "points")
        if begin == b"LASF":
            self.layout = las_layout(numpy, self._source)
        elif begin in (b"ply\n", b"ply\r"):
            self.layout = ply_layout(numpy, self._source)
        else:
            raise BadAnswer("points came in a format that this client does not read: PLY and LAS are")

    def chunks(self) -> "Iterator[Array]":
        """All points, in arrays of some megabytes."""
        layout = self.layout
        at_once = max(1, _CHUNK_BYTES // layout.record_bytes)
        left = layout.points
        while left > 0:
            wanted = min(left, at_once)
            data = self._source.up_to(wanted * layout.record_bytes)
            whole = len(data) // layout.record_bytes
            if whole:
                yield layout.decode(data[:whole * layout.record_bytes])
            if whole < wanted:
                raise BadAnswer(f"points end early: {layout.points - left + whole} of {layout.points} came")
            left -= whole

    def array(self) -> "Array":
        """All points in one array."""
        numpy = numpy_for("points as an array")
        all_of = numpy.empty(min(self.layout.points, _FIRST_POINTS), self.layout.dtype)
        filled = 0
        for chunk in self.chunks():
            if filled + len(chunk) > len(all_of):
                all_of.resize(min(self.layout.points, max(2 * len(all_of), filled + len(chunk))), refcheck=False)
            all_of[filled:filled + len(chunk)] = chunk
            filled += len(chunk)
        return all_of[:filled]  # type: ignore[no-any-return]
