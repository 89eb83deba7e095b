"""The head of a LAS → how its records are read: coordinates and scaled columns become doubles, bits get fields of their own."""
from __future__ import annotations

import struct
from typing import TYPE_CHECKING, Any, Callable, Dict, List, NamedTuple, Optional, Tuple

from ._point_layout import Layout, Source, dtype_of
from .errors import BadAnswer

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]

_RECORDS_LIMIT = 64 << 20  # what lies between the head and the points
_MOST_FIELDS = 1024
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


def las_layout(numpy: Any, source: Source) -> Layout:
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
    dtype = dtype_of(numpy, fields)

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
