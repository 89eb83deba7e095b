"""PNG files of 8 bits a channel, read and written with nothing but the standard library.

For scripts that look at pictures on machines that have no other library for it. A row's bytes are taken as one large
integer where the filter allows it, which makes it as quick as the pictures of `scancast` are large: 1280 x 720 pixels
with alpha take 0.1 s, about 1.5 s where every row has the one filter that must go byte by byte (Paeth). Not read:
palettes, 16 bits, interlaced pictures (ISO/IEC 15948, sections 9 and 11).
"""
import struct
import zlib
from typing import NamedTuple

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}  # of colour types: grey, RGB, grey and alpha, RGBA
COLOUR_TYPES = {channels: colour_type for colour_type, channels in CHANNELS.items()}
MOST_PIXELS = 16384 * 16384  # the largest picture that scancast draws


class Picture(NamedTuple):
    width: int
    height: int
    channels: int  # 1 grey, 2 grey and alpha, 3 RGB, 4 RGBA
    pixels: bytes  # row by row from the top, width * height * channels

    def channel(self, number):
        return self.pixels[number::self.channels]


class NotAPng(ValueError):
    """The bytes are no PNG, a damaged one, or one of a kind that is not read here."""


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    try:
        return decoded(data)
    except NotAPng as problem:
        raise NotAPng(f"{path}: {problem}") from None


def write(path, picture):
    with open(path, "wb") as file:
        file.write(encoded(picture))


def decoded(data):
    if not data.startswith(SIGNATURE):
        raise NotAPng("it does not begin as PNG files do")
    header, packed = None, []
    for name, body in chunks(data):
        if name == b"IHDR":
            header = struct.unpack(">IIBBBBB", body) if len(body) == 13 else None
        elif name == b"IDAT":
            packed.append(body)
        elif name == b"IEND":
            break
    else:
        raise NotAPng("it ends too early")
    if header is None:
        raise NotAPng("it has no header")
    width, height, depth, colour_type, compression, filtering, interlaced = header
    if depth != 8 or colour_type not in CHANNELS or compression or filtering or interlaced:
        raise NotAPng(f"{depth} bits a channel, colour type {colour_type}, interlaced {interlaced}: not read here")
    if not 0 < width * height <= MOST_PIXELS:
        raise NotAPng(f"it has {width} x {height} pixels")
    channels = CHANNELS[colour_type]
    size = height * (1 + width * channels)
    try:
        rows = zlib.decompressobj().decompress(b"".join(packed), size)
    except zlib.error as problem:
        raise NotAPng(str(problem)) from None
    if len(rows) != size:
        raise NotAPng(f"it has {len(rows)} bytes of rows, not {size}")
    return Picture(width, height, channels, unfiltered(rows, width * channels, height, channels))


def chunks(data):
    at = len(SIGNATURE)
    while at + 12 <= len(data):
        length, = struct.unpack_from(">I", data, at)
        name, body, check = data[at + 4:at + 8], data[at + 8:at + 8 + length], data[at + 8 + length:at + 12 + length]
        if len(check) != 4 or zlib.crc32(name + body) != int.from_bytes(check, "big"):
            raise NotAPng(f"chunk {name.decode('ascii', 'replace')} is damaged")
        yield name, body
        at += 12 + length


def encoded(picture):
    """The filter is "up" in every row: what is above is a good guess in pictures of scans."""
    width = picture.width * picture.channels
    if picture.channels not in COLOUR_TYPES or len(picture.pixels) != width * picture.height:
        raise ValueError(f"{len(picture.pixels)} bytes are no {picture.width} x {picture.height} pixels of {picture.channels} channels")
    lanes, rows, above = Lanes(width), [], 0
    for at in range(0, len(picture.pixels), width):
        row = int.from_bytes(picture.pixels[at:at + width], "little")
        rows.append(b"\2" + lanes.difference(row, above).to_bytes(width, "little"))
        above = row
    header = struct.pack(">IIBBBBB", picture.width, picture.height, 8, COLOUR_TYPES[picture.channels], 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(b"".join(rows), 6)), (b"IEND", b""))
    return SIGNATURE + b"".join(struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
                                for name, body in parts)


class Lanes:
    """Rows of bytes as one integer each, the first byte the lowest; every byte for itself, modulo 256."""

    def __init__(self, width):
        self.low = int.from_bytes(b"\x7f" * width, "little")
        self.high = int.from_bytes(b"\x80" * width, "little")
        self.all = self.low | self.high

    def sum(self, a, b):
        return ((a & self.low) + (b & self.low)) ^ ((a ^ b) & self.high)

    def difference(self, a, b):
        return ((a | self.high) - (b & self.low)) ^ ((a ^ b ^ self.high) & self.high)


def unfiltered(rows, width, height, step):
    """Pixels of filtered rows of `width` bytes; `step` bytes are a pixel."""
    lanes, found, above = Lanes(width), [], bytes(width)
    for at in range(0, height * (width + 1), width + 1):
        kind, row = rows[at], rows[at + 1:at + 1 + width]
        if kind == 1:
            row = summed_up(lanes, row, step)
        elif kind == 2:
            total = lanes.sum(int.from_bytes(row, "little"), int.from_bytes(above, "little"))
            row = total.to_bytes(width, "little")
        elif kind == 3:
            row = averaged(row, above, step)
        elif kind == 4:
            row = predicted(row, above, step)
        elif kind:
            raise NotAPng(f"row {at // (width + 1)} has filter {kind}")
        found.append(row)
        above = row
    return b"".join(found)


def summed_up(lanes, row, step):
    """Each byte plus all those of its channel on its left: sums of 1, 2, 4, ... pixels."""
    total, shift, width = int.from_bytes(row, "little"), step, len(row)
    while shift < width:
        total = lanes.sum(total, total << 8 * shift & lanes.all)
        shift *= 2
    return total.to_bytes(width, "little")


def averaged(row, above, step):
    done = bytearray(step) + row  # a pixel of zeros on the left
    for at, up in enumerate(above):
        done[at + step] = done[at + step] + (done[at] + up >> 1) & 255
    return bytes(done[step:])


def predicted(row, above, step):
    """The filter of Paeth: the nearest of left, above and above left to left + above - above left."""
    done = bytearray(len(row))
    for channel in range(step):
        left = corner = 0
        channel_done = []
        for value, up in zip(row[channel::step], above[channel::step]):
            from_left, from_up = up - corner, left - corner
            from_corner = abs(from_left + from_up)
            from_left, from_up = abs(from_left), abs(from_up)
            if from_left <= from_up and from_left <= from_corner:
                left = value + left & 255
            elif from_up <= from_corner:
                left = value + up & 255
            else:
                left = value + corner & 255
            corner = up
            channel_done.append(left)
        done[channel::step] = bytes(channel_done)
    return bytes(done)
