"""The range of an E57 file's points: their packets taken apart, spherical ones turned to Cartesian, each scan put where its pose says."""
import math
import struct

from declared.witness import Broken, Range

RECORDS_LOOKED_AT = 300_000


def strip(tag):
    return tag.rsplit("}", 1)[-1]


def child(node, *names):
    for name in names:
        node = next((c for c in node if strip(c.tag) == name), None) if node is not None else None
    return node


def number(node, name, otherwise=0.0):
    found = child(node, name) if node is not None else None
    return otherwise if found is None else float(found.text or 0)


def bounds(scans, logical, page):
    """`scans`: the XML elements; `logical`: the file without checksums, whose pages are of `page` bytes with them."""
    seen = Range()
    for scan in scans:
        vector = child(scan, "points")
        count = int(vector.attrib["recordCount"])
        if count == 0:
            continue
        if count > RECORDS_LOOKED_AT:
            return None
        columns = dict(zip(*decoded(vector, count, logical, page)))
        seen.take(placed(scan, points_of(columns)))
    return seen.bounds()


def decoded(vector, count, logical, page):
    """(names, columns): of each field its name and `count` values."""
    fields = list(child(vector, "prototype"))
    at = place(int(vector.attrib["fileOffset"]), page)
    _, length, data, _ = struct.unpack_from("<B7xQQQ", logical, at)
    end, at = at + length, place(data, page)
    streams = [bytearray() for _ in fields]
    while at < end:
        kind, size = logical[at], struct.unpack_from("<H", logical, at + 2)[0] + 1
        if kind == 1:
            parts = struct.unpack_from("<H", logical, at + 4)[0]
            if parts != len(fields):
                raise Broken(f"a packet of {parts} streams for {len(fields)} fields")
            start = at + 6 + 2 * parts
            for stream, some in zip(streams, struct.unpack_from(f"<{parts}H", logical, at + 6)):
                stream += logical[start:start + some]
                start += some
        at += size
    return [strip(field.tag) for field in fields], [values(field, stream, count) for field, stream in zip(fields, streams)]


def place(physical, page):
    return physical // page * (page - 4) + physical % page


def values(field, stream, count):
    about = field.attrib
    if about["type"] == "Float":
        letter = "f" if about.get("precision") == "single" else "d"
        return struct.unpack_from(f"<{count}{letter}", stream)
    if about["type"] not in ("Integer", "ScaledInteger"):
        return [None] * count
    least, most = int(about.get("minimum", -2**63)), int(about.get("maximum", 2**63 - 1))
    bits = (most - least).bit_length()
    if len(stream) * 8 < bits * count:
        raise Broken("a stream ends early")
    mask, scale, offset = (1 << bits) - 1, 1, 0
    if about["type"] == "ScaledInteger":
        scale, offset = float(about.get("scale", 1)), float(about.get("offset", 0))
    raw = (int.from_bytes(stream[k * bits // 8:(k * bits + bits + 7) // 8], "little") >> k * bits % 8 & mask for k in range(count))
    return [(value + least) * scale + offset for value in raw]


def points_of(columns):
    if "cartesianX" in columns:
        places = zip(*(columns["cartesian" + axis] for axis in "XYZ"))
        invalid = columns.get("cartesianInvalidState")
    else:
        places = ((r * math.cos(e) * math.cos(a), r * math.cos(e) * math.sin(a), r * math.sin(e)) for r, a, e in
                  zip(*(columns["spherical" + name] for name in ("Range", "Azimuth", "Elevation"))))
        invalid = columns.get("sphericalInvalidState")
    return [p for k, p in enumerate(places) if not invalid or invalid[k] == 0]


def placed(scan, points):
    pose = child(scan, "pose")
    rotation, shift = child(pose, "rotation"), child(pose, "translation")
    w, x, y, z = [number(rotation, name, 1.0 if name == "w" and rotation is None else 0.0) for name in "wxyz"]
    t = [number(shift, axis) for axis in "xyz"]
    m = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
         (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
         (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return [tuple(sum(row[k] * p[k] for k in range(3)) + t[axis] for axis, row in enumerate(m)) for p in points]
