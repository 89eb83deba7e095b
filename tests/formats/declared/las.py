"""LAS, LAZ and COPC: counts of the header; of uncompressed files also what the records hold (LAS Specification 1.4 - R15 of ASPRS)."""
import collections
import os
import struct

from declared.witness import Broken, Witness

RECORDS_LOOKED_AT = 3_000_000


def examine(path):
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        head = file.read(400)
        if len(head) < 227:
            return Witness("LAS", broken=f"{len(head)} bytes are no header")
        minor = head[25]
        start, vlrs, point_format, length, points = struct.unpack_from("<IIBHI", head, 96)
        if minor >= 4 and len(head) >= 255:
            points = struct.unpack_from("<Q", head, 247)[0] or points
        scale, offset = struct.unpack_from("<3d", head, 131), struct.unpack_from("<3d", head, 155)
        claimed = struct.unpack_from("<6d", head, 179)
        compressed = point_format & 0xC0 != 0
        found = Witness("LAZ" if compressed else "LAS", points, step=max(map(abs, scale)) * 0.01,
                        declared=(claimed[1::2], claimed[0::2]))
        if compressed:
            if head[375:].find(b"copc\0") == 2:
                found.format = "COPC"
            found.broken = compressed_fault(file, size, start, points) or laszip_fault(file, head, vlrs, length)
        elif start + points * length > size:
            found.broken = f"{points} records of {length} bytes do not fit into the file"
        elif length < 20:
            found.broken = f"records of {length} bytes"
        elif 0 < points <= RECORDS_LOOKED_AT:
            file.seek(start)
            look(found, file, point_format, length, points, scale, offset)
    return found


def compressed_fault(file, size, start, points):
    """Of LAZ the place of the chunk table is checked: the first 8 bytes of the points say it, or the file's last 8."""
    if points == 0:
        return ""
    file.seek(start)
    first = file.read(8)
    if len(first) < 8:
        return "the points are missing"
    table = struct.unpack("<q", first)[0]
    if table == -1:
        file.seek(size - 8)
        table = struct.unpack("<q", file.read(8))[0]
    # Files of the pointwise compressor, which has no chunks, are let through: their first bytes are data.
    return f"the chunk table would be at byte {table:,} of {size:,}" if size < table < 1 << 40 else ""


def laszip_fault(file, head, vlrs, length):
    """Of LASzip's own record: a coder, compressor or item that nobody ever wrote, or items that are no point together."""
    at = struct.unpack_from("<H", head, 94)[0]
    for _ in range(min(vlrs, 1000)):
        file.seek(at)
        vlr = file.read(54)
        if len(vlr) < 54:
            return "its records end early"
        user, kind, size = vlr[2:18].rstrip(b"\0"), *struct.unpack_from("<HH", vlr, 18)
        if user == b"laszip encoded" and kind == 22204:
            body = file.read(size)
            compressor, coder = struct.unpack_from("<HH", body)
            items = list(struct.iter_unpack("<HHH", body[34:34 + 6 * struct.unpack_from("<H", body, 32)[0]]))
            known = compressor in (1, 2, 3) and coder == 0 and all(item <= 14 and version <= 4 for item, _, version in items)
            return "" if known and sum(size for _, size, _ in items) == length else "its LASzip record describes no such points"
        at += 54 + size
    return "no LASzip record"


def look(found, file, point_format, length, points, scale, offset):
    at_class, mask = (16, 0xFF) if point_format >= 6 else (15, 0x1F)
    record = struct.Struct(f"<iiiH{at_class - 14}xB{length - at_class - 1}x")
    least, greatest, intensities, classes = [2**31] * 3, [-2**31] * 3, [], collections.Counter()
    left = points
    while left:
        some = min(left, 100_000)
        data = file.read(some * length)
        if len(data) != some * length:
            raise Broken("the records end early")
        *places, intensity, kinds = zip(*record.iter_unpack(data))
        for axis in range(3):
            least[axis] = min(least[axis], min(places[axis]))
            greatest[axis] = max(greatest[axis], max(places[axis]))
        intensities += [min(intensity), max(intensity)]
        for kind, count in collections.Counter(kinds).items():
            classes[kind & mask] += count
        left -= some
    found.bounds = tuple(tuple(v * s + o for v, s, o in zip(values, scale, offset)) for values in
                         ([min(a, b) if s >= 0 else max(a, b) for a, b, s in zip(least, greatest, scale)],
                          [max(a, b) if s >= 0 else min(a, b) for a, b, s in zip(least, greatest, scale)]))
    found.intensity = (min(intensities), max(intensities))
    found.classes = dict(classes)
