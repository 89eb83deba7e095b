"""Points, profiles and measurements: what is asked, what comes in chunks with lines behind them, and answers that end early or lie."""
import json
import os
import re
import tempfile
import unittest
import unittest.mock

import support
from points_test import las, ply

import scancast
from scancast import _exports, cloud, facts


def chunked(body, piece=1000, trailers=b"", end=True):
    parts = [b"%x\r\n%s\r\n" % (len(part), part) for part in (body[i:i + piece] for i in range(0, len(body), piece))]
    return b"".join(parts) + (b"0\r\n" + trailers + b"\r\n" if end else b"")


class Answering(unittest.TestCase):
    """`ask(cloud)` of a server that answers so; `self.asked` is the request's path and body."""

    def answered(self, ask, body, head=b"", status=b"200 OK"):
        def answer(connection):
            data = support.request_head(connection)
            head_, _, begun = data.partition(b"\r\n\r\n")
            size = int(re.search(rb"(?i)content-length: (\d+)", head_)[1])
            while len(begun) < size:
                begun += connection.recv(65536)
            self.asked = head_.split(b" ")[1].decode(), json.loads(begun)
            connection.sendall(b"HTTP/1.1 " + status + b"\r\n" + head + b"\r\n" + body)

        with support.lying(answer) as url:
            there = object.__new__(facts.CloudFacts)
            object.__setattr__(there, "id", "a town")
            object.__setattr__(there, "points", 1000)
            return ask(cloud.Cloud(scancast.Server(url, timeout=10)._transport, there))


CHUNKS = b"Transfer-Encoding: chunked\r\n"


@support.needs("numpy")
class Points(Answering):
    def test_a_region_is_asked_for_and_comes_as_an_array(self):
        points = self.answered(lambda cloud: cloud.points(classes=[2, 6], clip=((0, 0, 0), (1, 2, 3)), polygon=((0, 0), (1, 0), (1, 1)), z=(1, 2), normals=True),
                               chunked(ply(1000), 777), CHUNKS)
        self.assertEqual((len(points), points["x"][999]), (1000, 389400.999))
        self.assertEqual(self.asked, ("/api/v1/clouds/a%20town/points", {"format": "ply", "normals": True, "region": {
            "classes": [2, 6], "clip": {"min": [0, 0, 0], "max": [1, 2, 3]}, "polygon": [[0, 0], [1, 0], [1, 1]], "z": [1, 2]}}))

    def test_pieces_and_what_is_told_before_and_behind_them(self):
        def ask(cloud):
            with cloud.open_points() as stream:
                self.assertEqual((stream.count, stream.losses), (1000, ["colours have 8 bits", 'a "word"']))
                return sum(len(piece) for piece in stream), stream.losses
        found = self.answered(ask, chunked(ply(1000), trailers=b'Scancast-Losses: "rounded"\r\nOther: x\r\n'),
                              CHUNKS + b'Scancast-Losses: "colours have 8 bits", "a \\"word\\""\r\nScancast-Points: 1000\r\n')
        self.assertEqual(found, (1000, ["colours have 8 bits", 'a "word"', "rounded"]))
        self.assertEqual(self.asked[1], {"format": "ply"})

    def test_more_points_than_the_cloud_has_are_not_taken(self):
        now = object.__new__(facts.CloudFacts)
        with unittest.mock.patch.object(cloud.Cloud, "ask", return_value=now):
            object.__setattr__(now, "points", 1001)
            self.assertEqual(len(self.answered(lambda cloud: cloud.points(), chunked(ply(1001)), CHUNKS)), 1001, "it has grown")
            for ask in (lambda cloud: cloud.points(), lambda cloud: cloud.profile([(0, 0), (1, 1)])):
                with self.assertRaisesRegex(scancast.BadAnswer, "1002 points .* has 1001"):
                    self.answered(ask, chunked(ply(1002)), CHUNKS)

    def test_what_ends_early_is_not_taken_for_all(self):
        whole = ply(1000)
        for body, head in ((chunked(whole, end=False), CHUNKS), (chunked(whole)[:-500], CHUNKS), (chunked(whole[:-5]), CHUNKS), (chunked(whole + b"x"), CHUNKS),
                           (whole[:-5], b"Content-Length: %d\r\n" % len(whole)), (chunked(b"ply\n"), CHUNKS), (b"zz\r\n", CHUNKS),
                           (chunked(whole, trailers=b"a: b\r\n" * 1000), CHUNKS), (chunked(whole, trailers=b"a" * 100_000), CHUNKS)):
            with self.assertRaises(scancast.BadAnswer, msg=body[-40:]):
                self.answered(lambda cloud: cloud.points(), body, head)

    def test_a_profile_has_stations_and_says_how_long_it_is(self):
        def ask(cloud):
            with cloud.open_profile([(0, 0), (10, 5)], 0.5, classes=[6]) as stream:
                return stream.profile, stream.array().dtype.names
        found = self.answered(ask, chunked(ply(3, more=(("float", "station"), ("float", "offset")))), CHUNKS + b'Scancast-Profile: {"length": 11.2, "width": 0.5}\r\n')
        self.assertEqual(found[0], {"length": 11.2, "width": 0.5})
        self.assertEqual(found[1][-2:], ("station", "offset"))
        self.assertEqual(self.asked, ("/api/v1/clouds/a%20town/profile",
                                      {"format": "ply", "line": [[0, 0], [10, 5]], "width": 0.5, "region": {"classes": [6]}}))
        for wrong in (b"[]", b"{", b"5"):
            with self.assertRaises(scancast.BadAnswer):
                self.answered(ask, chunked(ply(3)), CHUNKS + b"Scancast-Profile: " + wrong + b"\r\n")


class Files(Answering):
    def test_a_file_is_what_came_or_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "a.las")
            saved = self.answered(lambda cloud: cloud.save_points(path, classes=[6]), chunked(las(500), trailers=b'Scancast-Losses: "late"\r\n'),
                                  CHUNKS + b"Scancast-Points: 500\r\n")
            self.assertEqual((saved, self.asked[1]["format"]), (scancast.Saved(500, ["late"]), "las"))
            with open(path, "rb") as file:
                self.assertEqual(file.read(), las(500))
            for name, body in (("b.csv", chunked(b"x,y,z\n", end=False)), ("c.ply", b"5\r\nab")):
                with self.assertRaises(scancast.BadAnswer):
                    self.answered(lambda cloud: cloud.save_profile(os.path.join(folder, name), [(0, 0), (1, 1)]), body, CHUNKS)
            self.assertEqual(os.listdir(folder), ["a.las"])
            with self.assertRaisesRegex(ValueError, "las"):
                self.answered(lambda cloud: cloud.save_points(os.path.join(folder, "a.laz")), b"")

    def test_a_picture_of_a_profile_knows_its_edges(self):
        ask = lambda cloud: cloud.profile_picture([(0, 0), (3, 4)], 2, picture={"point_size": 2, "color": "rgb"})  # noqa: E731
        picture = self.answered(ask, b"PNG", b'Content-Type: image/png\r\nContent-Length: 3\r\nScancast-Profile: {"left": 0, "right": 5, "bottom": 30.5, "top": 60, "length": 5}\r\n')
        self.assertEqual((picture.bytes, picture.left, picture.right, picture.bottom, picture.top, picture.length), (b"PNG", 0, 5, 30.5, 60, 5))
        self.assertEqual(self.asked[1], {"format": "png", "line": [[0, 0], [3, 4]], "width": 2, "picture": {"pointSize": 2, "color": "rgb"}})
        with self.assertRaises(scancast.BadAnswer):
            self.answered(ask, b"PNG", b'Content-Type: image/png\r\nContent-Length: 3\r\nScancast-Profile: {"left": "0"}\r\n')
        huge = self.answered(ask, b"PNG", b'Content-Type: image/png\r\nContent-Length: 3\r\nScancast-Profile: {"left": -1%s}\r\n' % (b"0" * 400))
        self.assertEqual(huge.left, -float("inf"))

    def test_losses_are_a_list_of_strings(self):
        self.assertEqual(_exports.strings_of('"a", "b\\\\\\"c"'), ["a", 'b\\"c'])
        for strange in ("", "a", '"', '"a', '"a\\', '""' * 1000):
            self.assertLessEqual(len(_exports.strings_of(strange)), 64)


class Places(Answering):
    def test_what_is_asked_and_what_is_answered(self):
        places = self.answered(lambda cloud: cloud.lonlat([(389500, 5819800), (0, 0)]), b'{"points": [[13.25, 52.5], null], "crs": null}', b"Content-Length: 46\r\n")
        self.assertEqual(places, [(13.25, 52.5), None])
        self.assertEqual(self.asked, ("/api/v1/clouds/a%20town/lonlat", {"to": "lonlat", "points": [[389500, 5819800], [0, 0]]}))
        for lie in (b"[]", b'{"points": []}', b'{"points": [[1]]}'):
            with self.assertRaises(scancast.BadAnswer):
                self.answered(lambda cloud: cloud.lonlat([(1, 2)], "file"), lie, b"Content-Length: %d\r\n" % len(lie))


class Measurements(Answering):
    def test_what_is_asked_and_what_is_answered(self):
        measured = self.answered(lambda cloud: cloud.measure("volume", [(0, 0), (1, 0), (1, 1)], base=3.5, classes=[6]),
                                 b'{"measure": "volume", "planArea": 0.5, "legs": [{"planLength": 1}], "base": {"at": [0, 0, 3.5]}}', b"Content-Length: 96\r\n")
        self.assertEqual((measured.measure, measured.plan_area, measured.legs[0].plan_length, measured["base"]["at"]), ("volume", 0.5, 1, [0, 0, 3.5]))
        self.assertEqual(self.asked, ("/api/v1/clouds/a%20town/measure",
                                      {"measure": "volume", "points": [[0, 0], [1, 0], [1, 1]], "base": 3.5, "view": {"classes": [6]}}))
        with self.assertRaisesRegex(AttributeError, "plan_area"):
            measured.radius
        with self.assertRaises(scancast.BadAnswer):
            self.answered(lambda cloud: cloud.measure("distance", []), b"[]", b"Content-Length: 2\r\n")


if __name__ == "__main__":
    unittest.main()
