"""The head of a binary PLY → how its rows are read. Pure but for what it is given to read from."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, Optional, Tuple

from ._point_layout import Layout, Source, dtype_of, number_of
from .errors import BadAnswer

if TYPE_CHECKING:
    import numpy

    Array = numpy.ndarray[Any, Any]

_HEAD_LIMIT = 64 << 10
_MOST_FIELDS = 1024
_TYPES: Dict[str, str] = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2", "uint16": "<u2",
    "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}


def ply_layout(numpy: Any, source: Source) -> Layout:
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
            count = number_of(words[2], "the number of points of a PLY")
        elif words[0] == "property" and len(words) == 3 and words[1] in _TYPES and count is not None and len(fields) < _MOST_FIELDS:
            fields.append((words[2], _TYPES[words[1]]))
        else:
            raise BadAnswer(f"the head of a PLY says what this client does not read: {line[:80]!r}")
    if not known_format or count is None or not fields:
        raise BadAnswer("a PLY without points, or not binary and little-endian, is not what this client reads")
    dtype = dtype_of(numpy, fields)

    def decode(data: bytes) -> "Array":
        return numpy.frombuffer(data, dtype)  # type: ignore[no-any-return]
    return Layout(count, dtype.itemsize, dtype, decode, crs)
