"""Points as files hold them, read by nothing of ours: LAS and PLY by struct, as their specifications lay them out, CSV by csv."""
import collections
import csv
import struct

Point = collections.namedtuple("Point", "x y z intensity color classification")


def read_las(data):
    """Header and points of LAS 1.0 to 1.4 (ASPRS LAS 1.4 R15, tables 3, 7, 10, 14 and 15)."""
    assert data[:4] == b"LASF"
    header_bytes, offset, records, form, length, legacy = struct.unpack_from("<HIIBHI", data, 94)
    minor = data[25]
    count = struct.unpack_from("<Q", data, 247)[0] if minor == 4 else legacy
    scale, origin = struct.unpack_from("<3d", data, 131), struct.unpack_from("<3d", data, 155)
    bounds = struct.unpack_from("<6d", data, 179)
    at, found = header_bytes, []
    for _ in range(records):
        user, number, size = struct.unpack_from("<2x16sHH", data, at)
        found.append((user.rstrip(b"\0").decode(), number, data[at + 54:at + 54 + size]))
        at += 54 + size
    assert at == offset, "the points stand directly behind the records"
    assert len(data) == offset + count * length
    color_at = {2: 20, 3: 28, 7: 30, 8: 30}.get(form)
    points = []
    for i in range(count):
        record = data[offset + i * length:offset + (i + 1) * length]
        steps = struct.unpack_from("<3i", record)
        color = tuple(c >> 8 for c in struct.unpack_from("<3H", record, color_at)) if color_at else None
        points.append(Point(*steps, struct.unpack_from("<H", record, 12)[0], color,
                            record[16] if form >= 6 else record[15] & 31))
    return {"minor": minor, "format": form, "scale": scale, "offset": origin, "bounds": bounds, "records": found,
            "legacy": legacy, "length": length,
            "returns": struct.unpack_from("<15Q", data, 255) if minor == 4 else ()}, points


def ply_rows(data):
    """Every vertex as {name: number}."""
    sizes = {"double": "d", "float": "f", "uchar": "B", "char": "b", "ushort": "H", "short": "h", "uint": "I", "int": "i"}
    head, _, body = data.partition(b"end_header\n")
    lines = head.decode("ascii").splitlines()
    assert lines[:2] == ["ply", "format binary_little_endian 1.0"]
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    properties = [line.split()[1:] for line in lines if line.startswith("property")]
    form = struct.Struct("<" + "".join(sizes[kind] for kind, _ in properties))
    assert len(body) == count * form.size
    names = [name for _, name in properties]
    return [dict(zip(names, values)) for values in form.iter_unpack(body)]


def read_ply(data, scale, origin):
    return [to_point(row, scale, origin) for row in ply_rows(data)]


def csv_rows(text):
    return [{k: float(v) for k, v in row.items()} for row in csv.DictReader(text.splitlines())]


def read_csv(text, scale, origin):
    return [to_point(row, scale, origin) for row in csv_rows(text)]


def to_point(values, scale, origin):
    steps = (round((values[axis] - o) / s) for axis, s, o in zip("xyz", scale, origin))
    return Point(*steps, int(values["intensity"]), tuple(int(values[c]) for c in ("red", "green", "blue")),
                 int(values["classification"]))


def in_polygon(corners, x, y):
    """Even-odd, by the corners' crossings of the ray to the right."""
    inside = False
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1]):
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
    return inside
