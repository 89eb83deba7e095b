"""PLY: the header's count of vertices, and their range (Turk, The PLY Polygon File Format)."""
import itertools
import os
import struct

from declared.witness import Broken, Range, Witness

TYPES = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H", "uint16": "H",
         "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f", "float32": "f", "double": "d", "float64": "d"}
BYTES_LOOKED_AT = 100_000_000


def examine(path):
    with open(path, "rb") as file:
        encoding, elements = read_header(file)
        names = [name for name, _, _ in elements]
        if "vertex" not in names:
            raise Broken("no vertices")
        if names[0] != "vertex":
            return Witness("PLY", elements[names.index("vertex")][1])
        _, points, properties = elements[0]
        found = Witness("PLY", points)
        columns = [name for name, _ in properties]
        if any(axis not in columns for axis in "xyz"):
            raise Broken("vertices without x, y and z")
        axes = [columns.index(axis) for axis in "xyz"]
        listed = any(kind is None for _, kind in properties)
        if points == 0 or (listed and encoding != "ascii") or os.path.getsize(path) > BYTES_LOOKED_AT:
            return found
        found.step = 0.0 if properties[axes[0]][1] == "d" else 1e-6
        if listed and max(axes) > [kind for _, kind in properties].index(None):
            return found
        seen = Range()
        if encoding == "ascii":
            lines = [line.split() for line in itertools.islice((l for l in file if l.strip()), points)]
            if len(lines) < points or any(len(line) < len(columns) for line in lines):
                raise Broken("the vertices end early")
            seen.take(tuple(float(line[axis]) for axis in axes) for line in lines)
        else:
            record = struct.Struct((">" if "big" in encoding else "<") + "".join(kind for _, kind in properties))
            for at in range(0, points, 100_000):
                some = min(points - at, 100_000)
                data = file.read(some * record.size)
                if len(data) != some * record.size:
                    raise Broken("the vertices end early")
                seen.take(tuple(values[axis] for axis in axes) for values in record.iter_unpack(data))
        found.bounds = seen.bounds()
        return found


def read_header(file):
    """(encoding, [(element, count, [(property, letter of its type, None for a list)])])"""
    encoding, elements = "", []
    for number in range(10_000):
        line = file.readline(65_536)
        if b"\r" in line.rstrip(b"\r\n"):
            raise Broken("lines end with CR alone")
        words = line.decode("latin1").split()
        if not line or (number == 0 and words != ["ply"]):
            raise Broken("no PLY header")
        if words[:1] == ["format"] and len(words) > 1:
            encoding = words[1]
        elif words[:1] == ["element"]:
            elements.append((words[1], int(words[2]), []))
        elif words[:2] == ["property", "list"]:
            elements[-1][2].append((words[-1], None))
        elif words[:1] == ["property"]:
            if words[1] not in TYPES:
                raise Broken(f"a property of the type {words[1]}")
            elements[-1][2].append((words[2], TYPES[words[1]]))
        elif words == ["end_header"]:
            if encoding not in ("ascii", "binary_little_endian", "binary_big_endian"):
                raise Broken(f"the encoding {encoding}")
            return encoding, elements
    raise Broken("a header without end")
