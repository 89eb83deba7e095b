"""E57: the sum of the scans' recordCounts, from the XML section behind its pages and checksums, and of small files the points' range
(ASTM E2807)."""
import os
import re
import struct
import xml.etree.ElementTree

from declared import e57_points
from declared.witness import Broken, Witness

CHECKED_BYTES = 4_000_000  # checksums are slow here
LOOKED_AT_BYTES = 100_000_000


def crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


TABLE = crc_table()


def crc32c(data):
    value = 0xFFFFFFFF
    for byte in data:
        value = TABLE[(value ^ byte) & 0xFF] ^ value >> 8
    return value ^ 0xFFFFFFFF


def pages(file, start, count, size, check):
    """The payloads of `count` pages of `size` bytes from byte `start` on, in one."""
    file.seek(start)
    out = []
    for _ in range(count):
        page = file.read(size)
        if len(page) != size:
            raise Broken("the file ends within a page")
        if check and struct.unpack(">I", page[-4:])[0] != crc32c(page[:-4]):
            raise Broken("a page with another checksum")
        out.append(page[:-4])
    return b"".join(out)


def examine(path):
    length = os.path.getsize(path)
    with open(path, "rb") as file:
        head = file.read(48)
        if len(head) < 48:
            raise Broken("a short header")
        major, _, declared, at, size, page = struct.unpack("<IIQQQQ", head[8:])
        if major != 1 or declared != length or page < 64 or page > 1 << 20 or length % page or at >= length or size > length:
            raise Broken("a header that contradicts the file")
        first, skip = at // page, at % page
        count = -(-(skip + size) // (page - 4)) + 1
        text = pages(file, first * page, min(count, length // page - first), page, True)[skip:skip + size]
        logical = pages(file, 0, length // page, page, length <= CHECKED_BYTES) if length <= LOOKED_AT_BYTES else None
    text = re.sub(rb"<(/?)[A-Za-z_][\w.-]*:", rb"<\1", text)  # prefixes that nobody declared are no reason to stop
    text = re.sub(rb"\s[A-Za-z_][\w.-]*:([\w.-]+\s*=)", rb" \1", text)
    root = xml.etree.ElementTree.fromstring(text)
    scans = list(e57_points.child(root, "data3D") or [])
    found = Witness("E57", sum(int(e57_points.child(scan, "points").attrib["recordCount"]) for scan in scans), step=1e-6)
    if logical is not None:
        found.bounds = e57_points.bounds(scans, logical, page)
    return found
