"""PCD: the header's count of points, and their range in all three encodings (Point Cloud Library, "The PCD file format", 0.7)."""
import os
import struct

from declared.witness import Broken, Range, Witness

BYTES_LOOKED_AT = 40_000_000
LETTERS = {"F4": "f", "F8": "d", "I1": "b", "I2": "h", "I4": "i", "I8": "q", "U1": "B", "U2": "H", "U4": "I", "U8": "Q"}


def examine(path):
    with open(path, "rb") as file:
        head = read_header(file)
        fields = head.get("FIELDS") or head.get("COLUMNS")
        if not fields or "DATA" not in head:
            raise Broken("no fields or no data")
        fields = [field.lower() for field in fields]
        sizes = head.get("SIZE") or ["4"] * len(fields)
        types = head.get("TYPE") or ["F"] * len(fields)
        counts = [int(c) for c in head.get("COUNT") or ["1"] * len(fields)]
        cells = int(head["WIDTH"][0]) * int(head["HEIGHT"][0]) if "WIDTH" in head and "HEIGHT" in head else None
        points = int(head["POINTS"][0]) if "POINTS" in head else cells
        if points is None or len({len(fields), len(sizes), len(types), len(counts)}) != 1:
            raise Broken("the header's lines disagree")
        if cells is not None and cells != points:
            raise Broken(f"WIDTH times HEIGHT is {cells}, POINTS is {points}")
        if any(axis not in fields for axis in "xyz"):
            raise Broken("points without x, y and z")
        found = Witness("PCD", points, step=1e-6)
        if points == 0 or os.path.getsize(path) > BYTES_LOOKED_AT:
            return found
        columns = [(LETTERS[t + s], int(s), c) for t, s, c in zip(types, sizes, counts)]
        read = {"ascii": read_ascii, "binary": read_binary, "binary_compressed": read_compressed}.get(head["DATA"][0])
        if read is None:
            raise Broken(f"the encoding {head['DATA'][0]}")
        seen = Range()
        seen.take(read(file, points, columns, [fields.index(axis) for axis in "xyz"]))
        found.bounds = seen.bounds()
        return found


def read_header(file):
    head = {}
    for _ in range(200):
        line = file.readline(65_536)
        words = line.decode("latin1").split()
        if not line:
            break
        if words and not words[0].startswith("#"):
            head[words[0]] = words[1:]
            if words[0] == "DATA":
                break
    return head


def read_ascii(file, points, columns, axes):
    starts = [sum(count for _, _, count in columns[:axis]) for axis in axes]
    width = sum(count for _, _, count in columns)
    lines = [words for words in (line.replace(b",", b" ").split() for line in file) if words]
    if len(lines) < points or any(len(words) < width for words in lines[:points]):
        raise Broken("the points end early")
    return [tuple(float(words[start]) for start in starts) for words in lines[:points]]


def read_binary(file, points, columns, axes):
    record = struct.Struct("<" + "".join(letter * count for letter, _, count in columns))
    data = file.read(points * record.size)
    if len(data) != points * record.size:
        raise Broken("the points end early")
    starts = [sum(count for _, _, count in columns[:axis]) for axis in axes]
    return (tuple(values[start] for start in starts) for values in record.iter_unpack(data))


def read_compressed(file, points, columns, axes):
    packed, whole = struct.unpack("<II", file.read(8))
    width = sum(size * count for _, size, count in columns)
    if whole < points * width:
        raise Broken("the unpacked points would be too few")
    data = file.read(packed)
    if len(data) != packed:
        raise Broken("the points end early")
    data = unpacked(data, whole)
    starts = [sum(size * count for _, size, count in columns[:axis]) * points for axis in axes]
    return zip(*(struct.unpack_from(f"<{points}{columns[axis][0]}", data, start) for axis, start in zip(axes, starts)))


def unpacked(data, size):
    """LZF, as Lehmann's liblzf writes it: runs of literals, and references of at most 264 bytes to at most 8192 before."""
    out, at = bytearray(), 0
    while at < len(data):
        control = data[at]
        at += 1
        if control < 32:
            out += data[at:at + control + 1]
            at += control + 1
            continue
        length = control >> 5
        if length == 7:
            length += data[at]
            at += 1
        start = len(out) - ((control & 31) << 8) - data[at] - 1
        at += 1
        if start < 0:
            raise Broken("compressed data refer to before their beginning")
        for k in range(length + 2):
            out.append(out[start + k])
    if len(out) != size:
        raise Broken("the compressed data are of another size")
    return out
