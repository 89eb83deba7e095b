"""PLY and LAS → arrays: what was written comes out, and any bytes make points or an error."""
import io
import random
import struct
import unittest
import unittest.mock

import support

from scancast import BadAnswer, point_data

try:
    import numpy
except ImportError:
    numpy = None


def ply(count=3, said=None, more=(), crs="comment crs WGS 84 / UTM zone 33N\n"):
    names = "".join(f"property {kind} {name}\n" for kind, name in (("double", "x"), ("double", "y"), ("double", "z"), ("uchar", "red"), ("ushort", "intensity"),
                                                                  ("double", "gps_time"), *more))
    head = f"ply\nformat binary_little_endian 1.0\ncomment scancast export ---\n{crs}element vertex {count if said is None else said}\n{names}end_header\n"
    return head.encode() + b"".join(struct.pack("<dddBHd", 389400 + i / 1000, 2 * i, -i, i % 256, i % 65536, i / 7) + bytes(4 * len(more)) for i in range(count))


def extra(name, kind, options=0, scale=0.0, offset=0.0):
    return (bytes([0, 0, kind, options]) + name.encode().ljust(32, b"\0") + bytes(4 + 24 * 3) + struct.pack("<3d", scale, scale, scale)
            + struct.pack("<3d", offset, offset, offset) + bytes(32))


def vlr(user, number, body):
    return bytes(2) + user.encode().ljust(16, b"\0") + struct.pack("<HH", number, len(body)) + bytes(32) + body


def las(count=3, point_format=7, said=None, extras=(), values=b"", minor=4, record_bytes=None, wkt="PROJCS[x]"):
    """Records whose fields follow from their number; `values`: each record's extra bytes."""
    records = (vlr("LASF_Spec", 4, b"".join(extras)) if extras else b"") + (vlr("LASF_Projection", 2112, wkt.encode() + b"\0") if wkt else b"")
    body = b""
    for i in range(count):
        record = struct.pack("<iiiH", i, 2 * i, -i, i % 65536)
        if point_format >= 6:
            record += struct.pack("<BBBBhHd", (i % 15 + 1) | 15 << 4, 0b11010010, i % 256, 7, -100 * (i % 100), 42, i / 7)
        else:
            record += struct.pack("<BBbBH", 2 | 3 << 3 | 1 << 6, i % 32 | 5 << 5, -(i % 90), 7, 42) + (struct.pack("<d", i / 7) if point_format & 1 else b"")
        if point_format in (2, 3, 7, 8):
            record += struct.pack("<HHH", 257 * (i % 256), 2, 3)
        if point_format == 8:
            record += struct.pack("<H", 99)
        body += record + values
    size = 375 if minor >= 4 else 227
    length = record_bytes or (len(body) // count if count else 36)
    total = count if said is None else said
    head = (b"LASF" + bytes(20) + bytes([1, minor]) + bytes(68) + struct.pack("<HII", size, size + len(records), bool(extras) + bool(wkt))
            + struct.pack("<BHI", point_format, length, 0 if minor >= 4 else total) + bytes(20) + struct.pack("<3d", 0.001, 0.01, 0.1)
            + struct.pack("<3d", 389400, 5819700, 30) + bytes(48))
    head += bytes(20) + struct.pack("<Q", total) + bytes(120) if minor >= 4 else b""
    assert len(head) == size, len(head)
    return head + records + body


def read(data, piece=None):
    stream = io.BytesIO(data)
    reader = point_data.PointReader((lambda size: stream.read(min(size, piece))) if piece else stream.read)
    return reader, reader.array()


@support.needs("numpy")
class Points(unittest.TestCase):
    def test_a_ply_is_its_rows(self):
        for piece in (None, 1, 7, 1000):
            reader, points = read(ply(), piece)
            self.assertEqual(points.dtype.names, ("x", "y", "z", "red", "intensity", "gps_time"))
            self.assertEqual(points[2].tolist(), (389400.002, 4.0, -2.0, 2, 2, 2 / 7))
            self.assertEqual(reader.layout.crs, "WGS 84 / UTM zone 33N")

    def test_a_las_is_its_records_with_bits_of_their_own(self):
        for piece in (None, 1, 1000):
            reader, points = read(las(300), piece)
            self.assertEqual((len(points), reader.layout.crs), (300, "PROJCS[x]"))
            at = points[250]
            self.assertEqual([at[name].item() for name in "xyz"], [250 * 0.001 + 389400, 500 * 0.01 + 5819700, -250 * 0.1 + 30])
            self.assertEqual([at[name].item() for name in ("return_number", "number_of_returns", "class_flags", "scanner_channel", "scan_direction_flag",
                                                           "edge_of_flight_line", "classification", "user_data", "point_source_id", "red", "green")],
                             [11, 15, 2, 1, 1, 1, 250, 7, 42, 257 * 250, 2])
            self.assertAlmostEqual(at["scan_angle"].item(), -5000 * 0.006, 4)
            self.assertEqual(at["gps_time"].item(), 250 / 7)

    def test_old_point_formats_and_versions(self):
        for point_format in (0, 1, 2, 3):
            for minor in (0, 2, 4):
                _, points = read(las(40, point_format, minor=minor))
                at = points[37]
                self.assertEqual([at[name].item() for name in ("return_number", "number_of_returns", "scan_direction_flag", "edge_of_flight_line",
                                                               "classification", "class_flags", "scan_angle")], [2, 3, 1, 0, 5, 5, -37])
                self.assertEqual("gps_time" in points.dtype.names, bool(point_format & 1))
                self.assertEqual("red" in points.dtype.names, point_format in (2, 3))

    def test_extra_bytes_have_their_names_scales_and_offsets(self):
        extras = [extra("height", 5, 8 | 16, 0.01, 100), extra("echo width", 9), extra("x", 3), extra("normal", 29), extra("", 0, 3), extra("big", 7)]
        values = struct.pack("<IfH3f3sQ", 250, 1.5, 65535, 1, 2, 3, b"abc", 2**63 + 1)
        _, points = read(las(5, 6, extras=extras, values=values + b"left"))
        at = points[4]
        self.assertEqual(at["height"].item(), 250 * 0.01 + 100)
        self.assertEqual((at["echo width"].item(), at["x_2"].item(), at["normal"].tolist(), at["field"].tolist(), at["big"].item()),
                         (1.5, 65535, [1, 2, 3], [97, 98, 99], 2**63 + 1))

    def test_arrays_grow_with_what_comes_and_not_with_what_is_said(self):
        _, points = read(ply(200_000))
        self.assertEqual((len(points), points["x"][-1]), (200_000, 389400 + 199_999 / 1000))
        for lie in (ply(3, said=10**15), las(3, said=10**14), las(3, said=4)):
            with self.assertRaisesRegex(BadAnswer, "3 of"):
                read(lie)

    def test_chunks_are_all_points_once(self):
        with unittest.mock.patch.object(point_data, "_CHUNK_BYTES", 1000):
            chunks = list(point_data.PointReader(io.BytesIO(las(500)).read).chunks())
        self.assertEqual([len(chunk) for chunk in chunks[:-1]], [1000 // 36] * (len(chunks) - 1))
        self.assertTrue((numpy.concatenate(chunks)["gps_time"] == numpy.arange(500) / 7).all())

    def test_what_is_none_is_an_error(self):
        sound = las()
        for wrong in (b"", b"ply", b"PLY\n", b"LASF", sound[:300], las(point_format=11), las(point_format=134), las(extras=[extra("a", 31)], values=b"a"),
                      las(extras=[extra("a", 10)], values=b"a"), las(record_bytes=20), sound[:24] + b"\2" + sound[25:],
                      sound[:94] + struct.pack("<H", 100) + sound[96:], sound[:96] + struct.pack("<I", 1 << 31) + sound[100:],
                      sound[:100] + struct.pack("<I", 1 << 30) + sound[104:], las(said=1 << 50),
                      ply().replace(b"binary_little_endian", b"ascii"), ply().replace(b"property double x", b"property list uchar int x"),
                      ply().replace(b"element vertex 3", b"element vertex -3"), ply().replace(b"end_header", b"element face 3\nend_header"),
                      b"ply\nformat binary_little_endian 1.0\nend_header\n", b"ply\n" + b"comment x\n" * 10_000):
            with self.assertRaises(BadAnswer, msg=wrong[:200]):
                read(wrong)

    def test_any_bytes_make_points_or_an_error(self):
        generator = random.Random(22)
        sound = [ply(), ply(0), las(), las(2, 3, minor=2), las(4, 6, extras=[extra("a", 5, 8, 0.5), extra("b", 13)], values=bytes(8))]
        for data in support.mutations(sound, generator, 1500):
            try:
                with numpy.errstate(all="ignore"):
                    read(data, generator.randint(1, 3000))
            except BadAnswer:
                pass


if __name__ == "__main__":
    unittest.main()
