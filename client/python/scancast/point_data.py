"""Points as a server sends them - binary PLY or LAS - → structured NumPy arrays, as they come.

Nothing is allocated because a head says so: arrays grow with the points that arrive, and what ends early or says what cannot be is a BadAnswer.
"""
from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple

from .errors import BadAnswer
from .picture import numpy_for

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]

Read = Callable[[int], bytes]
"""Up to so many bytes; b"" at the end."""

_CHUNK_BYTES = 4 << 20
_HEAD_LIMIT = 64 << 10
_RECORDS_LIMIT = 64 << 20  # of LAS: what lies between the head and the points
_MOST_FIELDS = 1024
_FIRST_POINTS = 1 << 16

_PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}


class _Source:
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


class PointReader:
    """Reads a head at once, and points as they are asked for."""

    def __init__(self, read: Read) -> None:
        """BadAnswer for what is neither PLY nor LAS; MissingLibrary without NumPy."""
        numpy = numpy_for("points as an array")
        self._source = _Source(read)
        begin = self._source.exactly(4, "points")
        if begin == b"LASF":
            self.layout = _las_layout(numpy, self._source)
        elif begin in (b"ply\n", b"ply\r"):
            self.layout = _ply_layout(numpy, self._source)
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


def _number(text: str, what: str) -> int:
    if not (text.isascii() and text.isdigit()) or len(text) > 19:
        raise BadAnswer(f"{what} is no number")
    return int(text)


def _dtype(numpy: Any, fields: List[Tuple[Any, ...]]) -> Any:
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


# ---- PLY

def _ply_layout(numpy: Any, source: _Source) -> Layout:
    head = source.until(b"end_header\n", _HEAD_LIMIT, "the head of a PLY")
    fields: List[Tuple[Any, ...]] = []
    count: Optional[int] = None
    crs, known_format = "", False
    for line in head.decode("utf-8", "replace").splitlines():
        words = line.split()
        if not words or words[0] == "obj_info":
            continue
        if words[0] == "comment":
            crs = line.split("crs ", 1)[1].strip() if line.startswith("comment crs ") else crs
        elif words[0] == "format":
            known_format = words[1:] == ["binary_little_endian", "1.0"]
        elif words[0] == "element" and len(words) == 3 and words[1] == "vertex" and count is None:
            count = _number(words[2], "the number of points of a PLY")
        elif words[0] == "property" and len(words) == 3 and words[1] in _PLY_TYPES and count is not None and len(fields) < _MOST_FIELDS:
            fields.append((words[2], _PLY_TYPES[words[1]]))
        else:
            raise BadAnswer(f"the head of a PLY says what this client does not read: {line[:80]!r}")
    if not known_format or count is None or not fields:
        raise BadAnswer("a PLY without points, or not binary and little-endian, is not what this client reads")
    dtype = _dtype(numpy, fields)

    def decode(data: bytes) -> "Array":
        return numpy.frombuffer(data, dtype)  # type: ignore[no-any-return]
    return Layout(count, dtype.itemsize, dtype, decode, crs)


# ---- LAS

_OLD = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("returns", "u1"), ("classes", "u1"), ("scan_angle", "i1"),
        ("user_data", "u1"), ("point_source_id", "<u2")]
_NEW = [("X", "<i4"), ("Y", "<i4"), ("Z", "<i4"), ("intensity", "<u2"), ("returns", "u1"), ("flags", "u1"), ("classification", "u1"),
        ("user_data", "u1"), ("scan_angle", "<i2"), ("point_source_id", "<u2"), ("gps_time", "<f8")]
_TIME = [("gps_time", "<f8")]
_COLOR = [("red", "<u2"), ("green", "<u2"), ("blue", "<u2")]
_NIR = [("nir", "<u2")]
_WAVE = [("waveform", "V29")]
_FORMATS: Dict[int, List[Tuple[str, str]]] = {
    0: _OLD, 1: _OLD + _TIME, 2: _OLD + _COLOR, 3: _OLD + _TIME + _COLOR, 4: _OLD + _TIME + _WAVE, 5: _OLD + _TIME + _COLOR + _WAVE,
    6: _NEW, 7: _NEW + _COLOR, 8: _NEW + _COLOR + _NIR, 9: _NEW + _WAVE, 10: _NEW + _COLOR + _NIR + _WAVE,
}
# (name, field of the record, bits to shift, bits that are left)
_OLD_BITS = [("return_number", "returns", 0, 7), ("number_of_returns", "returns", 3, 7), ("scan_direction_flag", "returns", 6, 1),
             ("edge_of_flight_line", "returns", 7, 1), ("classification", "classes", 0, 31), ("class_flags", "classes", 5, 7)]
_NEW_BITS = [("return_number", "returns", 0, 15), ("number_of_returns", "returns", 4, 15), ("class_flags", "flags", 0, 15),
             ("scanner_channel", "flags", 4, 3), ("scan_direction_flag", "flags", 6, 1), ("edge_of_flight_line", "flags", 7, 1)]
_ANGLE_STEP = 0.006
_EXTRA_TYPES = ["u1", "i1", "<u2", "<i2", "<u4", "<i4", "<u8", "<i8", "<f4", "<f8"]
_EXTRA_BYTES = 192


class _Extra(NamedTuple):
    name: str
    kind: str  # of NumPy
    values: int
    scale: Optional[List[float]]
    offset: List[float]


def _text(data: bytes) -> str:
    return data.split(b"\0", 1)[0].decode("utf-8", "replace").strip()


def _extra_of(record: bytes) -> _Extra:
    kind, options = record[2], record[3]
    name = _text(record[4:36])
    if kind == 0:
        return _Extra(name, "u1", options or 1, None, [])
    if kind > 30:
        raise BadAnswer(f"a LAS describes extra bytes of the unknown type {kind}")
    values = (kind - 1) // 10 + 1
    scale = list(struct.unpack_from("<3d", record, 112)) if options & 8 else None
    offset = list(struct.unpack_from("<3d", record, 136)) if options & 16 else [0.0, 0.0, 0.0]
    if scale is None and options & 16:
        scale = [1.0, 1.0, 1.0]
    return _Extra(name, _EXTRA_TYPES[(kind - 1) % 10], values, scale, offset)


def _variable_records(data: bytes, count: int) -> Tuple[List[_Extra], str]:
    """Extra bytes and the coordinate reference system's WKT."""
    extras: List[_Extra] = []
    crs, at = "", 0
    for _ in range(count):
        if at + 54 > len(data):
            raise BadAnswer("the records of a LAS end early")
        user, number, size = _text(data[at + 2:at + 18]), *struct.unpack_from("<HH", data, at + 18)
        body = data[at + 54:at + 54 + size]
        if len(body) < size:
            raise BadAnswer("a record of a LAS ends early")
        if user == "LASF_Spec" and number == 4:
            extras += [_extra_of(body[i:i + _EXTRA_BYTES]) for i in range(0, size - size % _EXTRA_BYTES, _EXTRA_BYTES)]
            if len(extras) > _MOST_FIELDS:
                raise BadAnswer("a LAS describes more extra bytes than a record can have")
        elif user == "LASF_Projection" and number == 2112:
            crs = _text(body)
        at += 54 + size
    return extras, crs


def _las_layout(numpy: Any, source: _Source) -> Layout:
    head = b"LASF" + source.exactly(223, "the head of a LAS")
    major, minor = head[24], head[25]
    size, begin, records = struct.unpack_from("<HII", head, 94)
    point_format, record_bytes, old_count = struct.unpack_from("<BHI", head, 104)
    scale, offset = struct.unpack_from("<3d", head, 131), struct.unpack_from("<3d", head, 155)
    if major != 1 or minor > 5 or size < 227 or size > begin or begin > _RECORDS_LIMIT:
        raise BadAnswer(f"a LAS {major}.{minor} with a head of {size} bytes and points at {begin} is none that this client reads")
    if point_format not in _FORMATS:
        raise BadAnswer(f"a LAS of point format {point_format} is none that this client reads" + (" (LAZ is compressed)" if point_format & 128 else ""))
    head += source.exactly(size - 227, "the head of a LAS")
    count = old_count
    if minor >= 4:
        if size < 375:
            raise BadAnswer("the head of a LAS 1.4 is too short")
        count = struct.unpack_from("<Q", head, 247)[0]
    if count >= 1 << 48:
        raise BadAnswer(f"a LAS cannot have {count} points")
    extras, crs = _variable_records(source.exactly(begin - size, "the records of a LAS"), records)

    fields: List[Tuple[Any, ...]] = list(_FORMATS[point_format])
    standard = numpy.dtype(fields).itemsize
    left = record_bytes - standard
    taken: List[_Extra] = []
    for extra in extras:
        taken_bytes = numpy.dtype(extra.kind).itemsize * extra.values
        if taken_bytes > left:
            raise BadAnswer("a LAS describes more extra bytes than its records have")
        left -= taken_bytes
        taken.append(extra)
        fields.append((f"extra {len(taken)}", extra.kind, (extra.values,)))
    if left < 0:
        raise BadAnswer(f"a LAS of point format {point_format} cannot have records of {record_bytes} bytes")
    if left:
        fields.append(("rest", f"V{left}"))
    raw = numpy.dtype(fields)
    return Layout(count, record_bytes, *_las_decoder(numpy, raw, point_format, taken, scale, offset), crs)


def _las_decoder(numpy: Any, raw: Any, point_format: int, extras: List[_Extra], scale: Tuple[float, ...],
                 offset: Tuple[float, ...]) -> Tuple[Any, "Callable[[bytes], Array]"]:
    """The dtype of the arrays, and what makes them of records: coordinates and scaled columns are doubles, bits have fields of their own."""
    new = point_format >= 6
    bits = _NEW_BITS if new else _OLD_BITS
    plain = [name for name, *_ in _FORMATS[point_format] if name in ("intensity", "user_data", "point_source_id", "gps_time", "red", "green", "blue", "nir")
             or (name == "classification" and new)]
    fields: List[Tuple[Any, ...]] = [("x", "<f8"), ("y", "<f8"), ("z", "<f8")]
    fields += [(name, raw[name]) for name in plain]
    fields += [(name, "u1") for name, *_ in bits]
    fields.append(("scan_angle", "<f4" if new else "i1"))
    first_extra = len(fields)
    for extra in extras:
        kind = "<f8" if extra.scale is not None else extra.kind
        fields.append((extra.name, kind, (extra.values,)) if extra.values > 1 else (extra.name, kind))
    dtype = _dtype(numpy, fields)

    def decode(data: bytes) -> "Array":
        records = numpy.frombuffer(data, raw)
        points = numpy.empty(len(records), dtype)
        for axis, (ours, theirs) in enumerate(zip("xyz", "XYZ")):
            points[ours] = records[theirs] * scale[axis] + offset[axis]
        for name in plain:
            points[name] = records[name]
        for name, field, shift, mask in bits:
            points[name] = (records[field] >> shift) & mask
        points["scan_angle"] = records["scan_angle"] * _ANGLE_STEP if new else records["scan_angle"]
        for i, extra in enumerate(extras):
            values = records[f"extra {i + 1}"]
            if extra.scale is not None:
                values = values * numpy.array(extra.scale[:extra.values]) + numpy.array(extra.offset[:extra.values])
            points[dtype.names[first_extra + i]] = values if extra.values > 1 else values[:, 0]
        return points  # type: ignore[no-any-return]
    return dtype, decode
