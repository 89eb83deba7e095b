"""Small files of most formats, each written here from its description, for survey_test.py."""
import json
import os
import struct

from declared.e57 import crc32c

POINTS = [(x * 0.25, x * x * 0.5, -1.0 - x) for x in range(40)]


def save(folder, name, content):
    path = os.path.join(folder, *name.split("/"))
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "wb") as file:
        file.write(content if isinstance(content, bytes) else content.encode())
    return path


def rows(points, form="{} {} {}\n"):
    return "".join(form.format(*point) for point in points)


def ply(encoding, points=POINTS, promised=None):
    head = f"ply\nformat {encoding} 1.0\nelement vertex {promised or len(points)}\n" + "".join(
        f"property float {axis}\n" for axis in "xyz") + "end_header\n"
    order = ">" if "big" in encoding else "<"
    return head.encode() + (rows(points).encode() if encoding == "ascii" else
                            b"".join(struct.pack(order + "3f", *point) for point in points))


def pcd(data, points=POINTS):
    head = (f"VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {len(points)}\nHEIGHT 1\n"
            f"POINTS {len(points)}\nDATA {data}\n").encode()
    if data == "ascii":
        return head + rows(points).encode()
    if data == "binary":
        return head + b"".join(struct.pack("<3f", *point) for point in points)
    plain = b"".join(struct.pack("<f", point[axis]) for axis in range(3) for point in points)
    packed = b"".join(bytes([len(plain[at:at + 32]) - 1]) + plain[at:at + 32] for at in range(0, len(plain), 32))
    return head + struct.pack("<II", len(packed), len(plain)) + packed


def las(points=POINTS, kept=None):
    """LAS 1.2, point format 0; `kept`: so many of the promised records are there."""
    head = bytearray(227)
    head[:4], head[24:26] = b"LASF", b"\1\2"
    places = [[round(v / 0.001) for v in point] for point in points]
    struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 0, 20, len(points))
    struct.pack_into("<6d", head, 131, 0.001, 0.001, 0.001, 0, 0, 0)
    struct.pack_into("<6d", head, 179, *(f(p[a] for p in points) for a in range(3) for f in (max, min)))
    records = [struct.pack("<iiiHBBbBH", *place, 100 + k, 9, k % 3, 0, 0, 7) for k, place in enumerate(places)]
    return bytes(head) + b"".join(records[:kept])


def ptx(points=POINTS):
    head = f"{len(points) // 2}\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n100 200 300 1\n"
    return head + rows([(0, 0, 0), *points[1:]], "{} {} {} 0.5\n")


def e57(points=POINTS):
    """Two scans, the second turned by a quarter about z and moved; x and y as floats, z in 7 bits."""
    half = len(points) // 2
    sections, about = b"", ""
    for part, pose in ((points[:half], ""), (points[half:], TURNED)):
        bits = sum((round(-p[2]) & 127) << 7 * k for k, p in enumerate(part))
        streams = [struct.pack(f"<{len(part)}f", *(p[axis] for p in part)) for axis in (0, 1)]
        streams.append(bits.to_bytes(-(-7 * len(part) // 8), "little"))
        packet = struct.pack("<H3H", 3, *map(len, streams)) + b"".join(streams)
        packet += bytes(-len(packet) % 4)
        at = physical(48 + len(sections))
        sections += struct.pack("<B7xQQQ", 1, 32 + 4 + len(packet), physical(48 + len(sections) + 32), 0)
        sections += struct.pack("<BBH", 1, 0, len(packet) + 3) + packet
        about += (f'<vectorChild type="Structure">{pose}<points type="CompressedVector" fileOffset="{at}" recordCount="{len(part)}">'
                  '<prototype type="Structure"><cartesianX type="Float" precision="single"/><cartesianY type="Float" precision="single"/>'
                  '<cartesianZ type="ScaledInteger" minimum="0" maximum="127" scale="-1"/></prototype></points></vectorChild>')
    text = (f'<?xml version="1.0"?><e57Root type="Structure" xmlns="http://www.astm.org/COMMIT/E57/2010-e57-v1.0">'
            f'<data3D type="Vector">{about}</data3D></e57Root>').encode()
    pages = -(-(48 + len(sections) + len(text)) // 1020)
    head = b"ASTM-E57" + struct.pack("<IIQQQQ", 1, 0, pages * 1024, physical(48 + len(sections)), len(text), 1024)
    logical = (head + sections + text).ljust(pages * 1020, b"\0")
    parts = [logical[at:at + 1020] for at in range(0, len(logical), 1020)]
    return b"".join(part + struct.pack(">I", crc32c(part)) for part in parts)


TURNED = ('<pose type="Structure"><rotation type="Structure"><w type="Float">0.7071067811865476</w><x type="Float">0</x>'
          '<y type="Float"/><z type="Float">0.7071067811865476</z></rotation><translation type="Structure"><x type="Float">100</x>'
          '<y type="Float">0</y><z type="Float">0</z></translation></pose>')


def physical(logical):
    return logical // 1020 * 1024 + logical % 1020


def ept(folder, said=12):
    save(folder, "ept.json", json.dumps({"points": said, "dataType": "binary", "bounds": [0, 0, 0, 1, 1, 1]}))
    save(folder, "ept-hierarchy/0-0-0-0.json", json.dumps({"0-0-0-0": 7, "1-0-0-0": -1}))
    save(folder, "ept-hierarchy/1-0-0-0.json", json.dumps({"1-0-0-0": 5}))
    for node in ("0-0-0-0", "1-0-0-0"):
        save(folder, f"ept-data/{node}.bin", b"-")
    return folder


def potree2(folder):
    save(folder, "metadata.json", json.dumps({"points": 12}))
    save(folder, "octree.bin", b"-")
    nodes = [(0, 1, 7, 0, 0), (2, 0, 5, 44, 22), (1, 0, 5, 0, 0)]  # the second is told where its chunk begins
    save(folder, "hierarchy.bin", b"".join(struct.pack("<BBIqq", *node) for node in nodes))
    return folder
