"""LAS made for tests: whatever header and colours are asked for, of points that lie on a bent surface."""
import math
import random
import struct


def surface(count, seed):
    """Whole steps of a grid, about 4,000 by 4,000 by 200."""
    chance = random.Random(seed)
    for _ in range(count):
        x, y = chance.randrange(4000), chance.randrange(4000)
        yield x, y, int(100 + 60 * math.sin(x / 500) + 40 * math.cos(y / 300)), chance


def las(path, count, seed=1, scale=(0.01, 0.01, 0.01), offset=(0.0, 0.0, 0.0), colors=65535, infrared=None, wkt=None):
    """LAS 1.2 with colours up to `colors` (point format 2), or, with `infrared` as its highest number or with `wkt`, LAS 1.4 (8)."""
    new = infrared is not None or wkt is not None
    records = bytearray()
    corners = [[math.inf] * 3, [-math.inf] * 3]
    for x, y, z, chance in surface(count, seed):
        color = [chance.randrange(colors + 1) for _ in range(3)]
        intensity, kind = chance.randrange(65536), chance.choice((2, 5, 6))
        if new:
            records += struct.pack("<3iHBBBBhHd3HH", x, y, z, intensity, 0x11, 0, kind, 0, 0, 1, x * 0.5, *color, chance.randrange((infrared or 0) + 1))
        else:
            records += struct.pack("<3iHBBbBH3H", x, y, z, intensity, 0x09, kind, 0, 0, 1, *color)
        for axis, step in enumerate((x, y, z)):
            at = offset[axis] + scale[axis] * step
            corners[0][axis], corners[1][axis] = min(corners[0][axis], at), max(corners[1][axis], at)
    if count == 0:
        corners = [[0.0] * 3] * 2
    vlr = b""
    if wkt is not None:
        text = wkt.encode() + b"\0"
        vlr = struct.pack("<H16sHH32s", 0, b"LASF_Projection", 2112, len(text), b"") + text
    head = 375 if new else 227
    bounds = [value for axis in range(3) for value in (corners[1][axis], corners[0][axis])]
    start = struct.pack("<4sHH16sBB32s32sHHHIIBHI5I", b"LASF", 0, 0x10 if new else 0, b"", 1, 4 if new else 2, b"tests", b"tests", 1, 2026, head,
                        head + len(vlr), 1 if vlr else 0, 8 if new else 2, 38 if new else 26, 0 if new else count, *([0] * 5))
    start += struct.pack("<12d", *scale, *offset, *bounds)
    if new:
        start += struct.pack("<QQIQ15Q", 0, 0, 0, count, *([0] * 15))
    assert len(start) == head
    with open(path, "wb") as file:
        file.write(start + vlr + records)
