"""PNG files are read as the format says, whatever the filter of a row, and damaged ones are refused. The oracle is the
filters as they stand in the standard (ISO/IEC 15948, section 9), one byte at a time, forwards."""
import os
import random
import struct
import sys
import tempfile
import unittest
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))
import png_file  # noqa: E402


def paeth(left, up, corner):
    guess = left + up - corner
    return min((abs(guess - left), 0, left), (abs(guess - up), 1, up), (abs(guess - corner), 2, corner))[2]


def filtered(kind, row, above, step):
    guesses = {
        0: lambda left, up, corner: 0,
        1: lambda left, up, corner: left,
        2: lambda left, up, corner: up,
        3: lambda left, up, corner: (left + up) // 2,
        4: paeth,
    }
    found = bytearray([kind])
    for at, value in enumerate(row):
        left, corner = (row[at - step], above[at - step]) if at >= step else (0, 0)
        found.append((value - guesses[kind](left, above[at], corner)) % 256)
    return bytes(found)


def chunk(name, body):
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def png(width, height, colour_type, rows, pieces=1, header=(8, None, 0, 0, 0)):
    packed = zlib.compress(rows)
    cut = -(-len(packed) // pieces)
    depth, _, compression, filtering, interlaced = header
    return (png_file.SIGNATURE + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, colour_type, compression, filtering, interlaced))
            + chunk(b"tEXt", b"Title\0hand-made")
            + b"".join(chunk(b"IDAT", packed[at:at + cut]) for at in range(0, len(packed), cut)) + chunk(b"IEND", b""))


def hand_made(width, height, channels, kinds, seed=7):
    """Pixels, and the file whose rows have these filters in turn."""
    dice = random.Random(seed)
    rows = [bytes(dice.choice((0, 1, 127, 128, 254, 255, dice.randrange(256))) for _ in range(width * channels)) for _ in range(height)]
    above = [bytes(width * channels), *rows]
    written = b"".join(filtered(kinds[y % len(kinds)], row, above[y], channels) for y, row in enumerate(rows))
    return b"".join(rows), png(width, height, png_file.COLOUR_TYPES[channels], written, pieces=3)


class Reading(unittest.TestCase):
    def test_every_filter_of_every_kind_of_pixel(self):
        for channels in (1, 2, 3, 4):
            for kind in range(5):
                for width in (1, 2, 37):
                    with self.subTest(channels=channels, kind=kind, width=width):
                        pixels, data = hand_made(width, 9, channels, [kind])
                        self.assertEqual(png_file.decoded(data), (width, 9, channels, pixels))

    def test_filters_that_change_from_row_to_row(self):
        pixels, data = hand_made(23, 60, 4, [4, 1, 3, 0, 2, 1, 1, 4, 4, 3, 3, 2, 2])
        self.assertEqual(png_file.decoded(data).pixels, pixels)

    def test_what_cannot_be_read_is_refused_with_a_reason(self):
        pixels, good = hand_made(5, 4, 3, [1])
        self.assertEqual(png_file.decoded(good).pixels, pixels)
        wrong = {
            "begin": b"GIF89a" + good,
            "early": good[:-12],
            "damaged": good.replace(b"hand-made", b"hand-mode"),
            "filter 5": png(1, 1, 2, b"\5abc"),
            "bytes of rows": png(2, 2, 2, b"\0abcdef"),
            "16 bits": png(1, 1, 2, b"\0abcdef", header=(16, None, 0, 0, 0)),
            "interlaced 1": png(1, 1, 2, b"\0abc", header=(8, None, 0, 0, 1)),
            "colour type 3": png(1, 1, 3, b"\0a"),
            "0 x 1": png(0, 1, 2, b""),
            "no header": png_file.SIGNATURE + chunk(b"IEND", b""),
        }
        for reason, data in wrong.items():
            with self.subTest(reason=reason), self.assertRaisesRegex(png_file.NotAPng, reason):
                png_file.decoded(data)
        for length in range(len(good) - 12):
            with self.assertRaises(png_file.NotAPng):
                png_file.decoded(good[:length])


class Writing(unittest.TestCase):
    def test_what_is_written_is_read_again(self):
        for channels in (1, 2, 3, 4):
            pixels, _ = hand_made(31, 17, channels, [0])
            picture = png_file.Picture(31, 17, channels, pixels)
            self.assertEqual(png_file.decoded(png_file.encoded(picture)), picture)

    def test_a_file_of_it(self):
        picture = png_file.Picture(2, 1, 3, b"\0\1\2\xfd\xfe\xff")
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "two.png")
            png_file.write(path, picture)
            self.assertEqual(png_file.read(path), picture)
            with open(path, "r+b") as file:
                file.truncate(20)
            with self.assertRaisesRegex(png_file.NotAPng, "two.png"):
                png_file.read(path)
        self.assertEqual(picture.channel(2), b"\2\xff")

    def test_pixels_that_do_not_fill_the_picture(self):
        with self.assertRaises(ValueError):
            png_file.encoded(png_file.Picture(2, 2, 3, b"abc"))


if __name__ == "__main__":
    unittest.main()
