"""Frames of a stream and their depth in cells: what was packed comes out, and any bytes make a frame or an error."""
import math
import random
import struct
import unittest
import zlib

import support

from scancast import BadAnswer, frames


def value_of(code):
    """1 / depth x near of a code, as PROTOCOL.md writes it."""
    octave = max(0, code // 512 - 1)
    return (code - 512 * octave) * 2.0 ** (octave - 24)


def pack(codes, width, near, far):
    """Cells' codes, None for background, as a server packs them: PROTOCOL.md, "Depth of a frame", read the other way."""
    seen, symbols = [], []
    for i, code in enumerate(codes):
        row, column = divmod(i, width)
        left = seen[i - 1] if column else None
        above = seen[i - width] if row else None
        if row == 0:
            predicted = left if column else 0
        elif column == 0:
            predicted = above
        else:
            predicted = min(max(left + above - seen[i - width - 1], min(left, above)), max(left, above))
        if code is None:
            symbols.append(0)
            seen.append(predicted)
        else:
            step = code - predicted
            symbols.append(2 * step + 1 if step >= 0 else -2 * step)
            seen.append(code)
    return zlib.compress(bytes(s & 255 for s in symbols) + bytes(s >> 8 for s in symbols))


def frame(jpeg=b"\xff\xd8picture\xff\xd9", flags=6, depth=None, number=7, seq=3, width=640, height=360):
    """`depth`: (width, height, near, far, packed)."""
    more = struct.pack("<HHIff", depth[0], depth[1], len(depth[4]), depth[2], depth[3]) + depth[4] if depth else b""
    return struct.pack("<4sHHBBHIQQIIII", b"SCFR", 1, 48 + len(more), 1, flags, 0, len(jpeg), number, seq, width, height, 1500, 250) + more + jpeg


def some_cells(generator, width, height):
    return [None if generator.random() < 0.2 else generator.randint(1, 8192) for _ in range(width * height)]


class Frames(unittest.TestCase):
    def test_fields_are_what_the_header_says(self):
        read = frames.parse_frame(frame(flags=0b11110))
        self.assertEqual((read.id, read.seq, read.width, read.height, read.jpeg), (7, 3, 640, 360, b"\xff\xd8picture\xff\xd9"))
        self.assertEqual((read.moving, read.still, read.final, read.damaged, read.away), (False, True, True, True, True))
        self.assertEqual((read.render_seconds, read.encode_seconds, read.depth), (0.0015, 0.00025, None))
        self.assertTrue(frames.parse_frame(frame(flags=1)).moving)

    def test_a_longer_header_is_skipped(self):
        data = frame()
        longer = data[:6] + struct.pack("<H", 60) + data[8:48] + b"123456789abc" + data[48:]
        self.assertEqual(frames.parse_frame(longer).jpeg, frames.parse_frame(data).jpeg)

    def test_cells_are_the_depth_that_was_packed(self):
        generator = random.Random(1)
        for width, height in ((1, 1), (5, 3), (160, 90), (1, 160)):
            codes = some_cells(generator, width, height)
            cells = frames.parse_frame(frame(depth=(width, height, 2.5, 1000.0, pack(codes, width, 2.5, 1000.0)))).depth
            expected = [0.0 if code is None else value_of(code) / 2.5 for code in codes]
            self.assertEqual(cells.inverse(), expected)
        self.assertEqual(value_of(8192), 1.0)

    @support.needs("numpy")
    def test_depth_is_an_array_with_infinity_for_background(self):
        cells = frames.parse_frame(frame(depth=(3, 1, 2.0, 4.0, pack([8192, None, 8192 - 512], 3, 2.0, 4.0)))).depth.array()
        self.assertEqual((cells.shape, cells.dtype.name), ((1, 3), "float32"))
        self.assertEqual(list(cells[0]), [2.0, math.inf, 4.0])

    def test_what_is_no_frame_is_an_error(self):
        sound = frame()
        for wrong in (b"", sound[:47], b"XXXX" + sound[4:], sound[:4] + b"\2\0" + sound[6:], sound + b"x", sound[:-1], sound[:8] + b"\2" + sound[9:],
                      sound[:6] + b"\x2f\0" + sound[8:], sound[:6] + b"\xff\xff" + sound[8:], frame(width=0), frame(height=16385)):
            with self.assertRaises(BadAnswer):
                frames.parse_frame(wrong)
        packed = pack([8192], 1, 1.0, 1.0)
        for depth in ((0, 1, 1.0, 1.0, packed), (161, 1, 1.0, 1.0, packed), (1, 1, 2.0, 1.0, packed), (1, 1, math.nan, 1.0, packed),
                      (1, 1, 1.0, math.inf, packed), (1, 1, -1.0, 1.0, packed)):
            with self.assertRaises(BadAnswer):
                frames.parse_frame(frame(depth=depth))

    def test_cells_that_mean_nothing_are_an_error(self):
        bomb = zlib.compress(bytes(50_000_000), 9)
        for packed in (b"", b"nonsense", zlib.compress(b""), zlib.compress(b"123"), zlib.compress(b"\1\1\0\0") + b"x", bomb,
                       zlib.compress(bytes([255, 1, 255, 0])), zlib.compress(bytes([0, 0, 0, 0]))[:-2]):
            with self.assertRaises(BadAnswer):
                frames.DepthCells(2, 1, 1.0, 1.0, packed).inverse()

    def test_any_bytes_make_a_frame_or_an_error(self):
        generator = random.Random(21)
        sound = [frame(), frame(depth=(4, 3, 1.0, 9.0, pack(some_cells(generator, 4, 3), 4, 1.0, 9.0))), frame(jpeg=b"")]
        for data in support.mutations(sound, generator, 3000):
            try:
                read = frames.parse_frame(data)
                if read.depth:
                    inverse = read.depth.inverse()
                    self.assertEqual(len(inverse), read.depth.width * read.depth.height)
                    self.assertTrue(all(0 <= value and math.isfinite(value) for value in inverse))
            except BadAnswer:
                pass


if __name__ == "__main__":
    unittest.main()
