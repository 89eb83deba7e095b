"""client/python against a real server: clouds, pictures, depth, picks, refusals, live views; over TLS with a token; for a guest.

SCANCAST_PROGRAMS names the folder of the programs.
"""
import json
import math
import os
import secrets
import subprocess
import threading
import time
import unittest
import urllib.request

import support

import scancast
from scancast import cloud, facts, words

SMALL = {"width": 160, "height": 90}


class Server(support.Served):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.scancast = scancast.Server(cls.url, timeout=support.PATIENCE)
        support.wait_until(lambda: cls.scancast.ready() and not cls.scancast.pending(), "the cloud is not there")
        cls.cloud = cls.scancast.cloud()

    def raw(self, path):
        with urllib.request.urlopen(self.url + path, timeout=support.PATIENCE) as answer:
            return answer.read()

    def test_facts_are_what_the_server_says(self):
        said = json.loads(self.raw("/api/v1/clouds"))["clouds"][0]
        cloud = self.cloud
        self.assertEqual((cloud.id, cloud.title, cloud.point_count, list(cloud.bounds.min), cloud.unit, cloud.crs, cloud.spacing),
                         (said["id"], said["title"], said["points"], said["bounds"]["min"], said["crsUnit"], said["crsName"], said["spacing"]))
        self.assertEqual(cloud.facts.json["view"], said["view"])
        self.assertEqual(cloud.point_count, self.points)
        self.assertEqual(cloud.classes[2], "ground")
        self.assertIn("rgb", [one.name for one in cloud.attributes])
        self.assertEqual(self.scancast.cloud("town").refresh().facts.revision, said["revision"])
        self.assertEqual([one.id for one in self.scancast.clouds()], ["town"])
        self.assertIn("/api/v1/clouds", self.scancast.openapi()["paths"])

    def test_methods_and_their_parameters(self):
        methods = self.scancast.methods()
        self.assertEqual(len(methods), len(json.loads(self.raw("/api/v1/methods"))["methods"]))
        self.assertIn("scale", [one.name for one in methods["ewa"].parameters])
        self.assertIn("elevation", methods.colors)
        self.assertRaises(KeyError, lambda: methods["none"])

    def test_places_to_look_from(self):
        views = self.cloud.views(color="elevation", **SMALL)
        self.assertGreater(len(views), 1)
        self.assertEqual((views[0].view["color"], views[0].view["width"]), ("elevation", 160))
        self.assertEqual(self.cloud.snapshot(views[0]).bytes, self.cloud.snapshot(views[0].view).bytes)
        self.assertEqual((self.cloud.stations(), self.cloud.photos()), ([], []))
        self.assertRaises(scancast.NotFound, self.cloud.photo, 0)

    def test_a_picture_is_the_servers_bytes(self):
        query = "eye=389500,5819650,90&target=389500,5819800,40&method=cone&param.sizePx=3&color=%23ff8800&width=160&height=90&classes=2,6"
        given = {"eye": (389500, 5819650, 90), "target": (389500, 5819800, 40), "method": "cone", "param": {"sizePx": 3}, "color": "#ff8800",
                 "classes": [2, 6], **SMALL}
        for ending in ("png", "jpg"):
            picture = self.cloud.snapshot(format=ending, **given)
            self.assertEqual(picture.bytes, self.raw(f"/api/v1/clouds/town/snapshot.{ending}?{query}"))
            self.assertEqual(picture.method, "cone")
        self.assertTrue(picture.etag and picture.timing and picture.price is not None)
        self.assertIs(self.cloud.snapshot(format="jpg", known=picture, **given), picture)
        self.assertIsNot(self.cloud.snapshot(format="jpg", known=picture, **{**given, "color": "#000000"}), picture)
        auto = self.cloud.snapshot(**SMALL)
        self.assertTrue(auto.method and auto.reason)
        self.assertTrue(self.cloud.link(**given).startswith(self.url + "/#cloud=town&eye=389500,5819650,90&"))

    def test_every_word_reaches_the_server_in_both_spellings(self):
        given = {"projection": "orthographic", "view_height": 60, "eye": (389500, 5819800, 300), "target": (389500, 5819800, 0), "up": (0, 1, 0),
                 "near": "auto", "far": None, "exposure": None, "colormap": "turbo", "range": (30, 60), "clip": (389400, 5819700, 0, 389600, 5819900, 99),
                 "shading": "phong", "light": {"ambient": 0.3, "sun": (135, 40), "occlusion": "auto"}, "mirrors": False, "behind_mirrors": True,
                 "outliers": "show", "background": ("#ffffff", "#000000"), "detail": 2, "budget": "auto", "samples": 1, "quality": 50,
                 "subsampling": "4:4:4", "color": "elevation", **SMALL}
        if "clips" in words.PLACES:  # a word of newer servers
            given["clips"] = "box:389500,5819800,40,150,150,60,30;-box:389500,5819800,40,10,10,60"
        by_query = self.raw("/api/v1/clouds/town/snapshot.png?" + words.query(words.words_text(words.view_of(given))))
        self.assertEqual(self.cloud.snapshot(**given).bytes, by_query)

    @support.needs("numpy", "PIL")
    def test_arrays(self):
        picture = self.cloud.snapshot(background="transparent", **SMALL)
        pixels = picture.array()
        self.assertEqual((pixels.shape, pixels.dtype.name), ((90, 160, 4), "uint8"))
        self.assertEqual(self.cloud.snapshot(format="jpg", **SMALL).array().shape, (90, 160, 3))
        depth = self.cloud.depth(samples=1, **SMALL)
        self.assertEqual((depth.shape, depth.dtype.name), ((90, 160), "float32"))
        self.assertEqual(depth.tobytes(), self.cloud.depth_picture(**SMALL).bytes)
        self.assertTrue((depth == math.inf).any() and (depth < math.inf).any())

    def test_a_picked_point_is_one_of_the_scan(self):
        depth = self.cloud.depth_picture(**SMALL)
        import struct
        values = struct.unpack(f"<{160 * 90}f", depth.bytes)
        at = min(range(len(values)), key=lambda i: values[i])
        point = self.cloud.pick(at % 160, at // 160, **SMALL)
        self.assertIsNotNone(point)
        self.assertTrue(all(low <= value <= high for low, value, high in zip(self.cloud.bounds.min, point.position, self.cloud.bounds.max)))
        self.assertEqual(point.json["position"], list(point.position))
        background = max(range(len(values)), key=lambda i: values[i])
        self.assertIsNone(self.cloud.pick(background % 160, background // 160, **SMALL))

    def test_pictures_are_saved_whole_or_not_at_all(self):
        path = os.path.join(self.folder, "a.jpg")
        picture = self.cloud.save(path, **SMALL)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), picture.bytes)
        with self.assertRaises(scancast.ScancastError):
            self.cloud.save(path, fov=-1)
        with open(path, "rb") as file:
            self.assertEqual(file.read(), picture.bytes)
        self.assertRaises(ValueError, self.cloud.save, os.path.join(self.folder, "a.bmp"))
        self.assertRaises(OSError, picture.save, os.path.join(self.folder, "no", "a.jpg"))
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith(".")], [])

    def test_what_is_refused_says_what_to_do(self):
        cloud = self.cloud
        for ask, kind, text in ((lambda: cloud.snapshot(fvo=60), scancast.InvalidArgument, "fvo: unknown; did you mean fov?"),
                                (lambda: cloud.snapshot(view_hieght=6), scancast.InvalidArgument, "view_hieght: unknown; did you mean view_height?"),
                                (lambda: cloud.pick(1, 1, fvo=60), scancast.InvalidArgument, "did you mean fov?"),
                                (lambda: cloud.live(fvo=60), scancast.InvalidArgument, "did you mean fov?"),
                                (lambda: cloud.snapshot(method="conee"), scancast.ScancastError, "cone"),
                                (lambda: cloud.snapshot(light={"sunn": 1}), scancast.InvalidArgument, "did you mean sun?"),
                                (lambda: cloud.snapshot(eye=(1, 1, 1), target=(1, 1, 1)), scancast.Impossible, ""),
                                (lambda: cloud.snapshot(color="cir"), scancast.Impossible, ""),
                                (lambda: self.scancast.cloud("nothing"), scancast.NotFound, "nothing")):
            with self.assertRaises(kind) as caught:
                ask()
            self.assertIn(text, str(caught.exception))
            self.assertTrue(caught.exception.status)
        with self.assertRaises(scancast.TooLarge) as caught:
            cloud.snapshot(width=16384, height=3906, samples=64, method="ewa")
        self.assertTrue(caught.exception.nearest)

    def test_a_notebook_shows_clouds_and_pictures(self):
        shown = self.cloud._repr_html_()
        self.assertIn("data:image/jpeg;base64,", shown)
        self.assertIn("30,000", shown)
        png, jpg = self.cloud.snapshot(**SMALL), self.cloud.snapshot(format="jpg", **SMALL)
        self.assertEqual((png._repr_png_(), png._repr_jpeg_(), jpg._repr_jpeg_()), (png.bytes, None, jpg.bytes))
        page = self.cloud.page(color="elevation", page_height=300)._repr_html_()
        self.assertIn(f'src="{self.url}/#cloud=town&amp;color=elevation"', page)

    def test_a_live_view_shows_what_was_asked_for_last(self):
        with self.cloud.live(depth=True, **SMALL) as live:
            first = live.still()
            self.assertEqual((first.seq, first.width, first.height, first.final), (0, 160, 90, True))
            self.assertEqual(first.jpeg, self.cloud.snapshot(format="jpg", **SMALL).bytes, "a final still is the snapshot")
            self.assertEqual(len(first.depth.inverse()), first.depth.width * first.depth.height)
            last = [live.view(eye=(389500 + i, 5819650, 90)) for i in range(20)][-1]
            self.assertEqual(live.still().seq, last)
            at = self.cloud.snapshot(format="jpg", eye=(389519, 5819650, 90), **SMALL)
            self.assertEqual(live.still().jpeg, at.bytes)
            point = live.pick(80, 45)
            self.assertEqual(point, self.cloud.pick(80, 45, eye=(389519, 5819650, 90), **SMALL))
            with self.assertRaisesRegex(scancast.InvalidArgument, "did you mean fov"):
                live.still(fvo=3)
            self.assertEqual(live.still(width=80, height=45).width, 80)
            self.assertEqual(live.stats["type"], "stats")
        self.assertRaises(scancast.ConnectionFailed, live.view, color="rgb")
        self.assertEqual(list(live), [])

    def test_an_iterator_gives_the_newest_frame_only(self):
        with self.cloud.live(**SMALL) as live:
            seen = []

            def move():
                for i in range(30):
                    live.view(eye=(389500 + i, 5819650, 90))
                    time.sleep(0.01)

            live.still()
            mover = threading.Thread(target=move)
            mover.start()
            for frame in live:
                seen.append((frame.id, frame.seq))
                time.sleep(0.03)
                if frame.final and frame.seq == 30:
                    break
            mover.join()
        self.assertEqual(seen, sorted(set(seen)), "none is older, and none comes twice")

    def test_a_session_that_lost_its_connection_goes_on(self):
        with self.cloud.live(**SMALL) as live:
            seq = live.still(eye=(389510, 5819650, 90)).seq
            before, newest, old = live.session, live._newest, live._socket
            old._socket.shutdown(2)
            support.wait_until(lambda: old._gone, "nobody noticed")
            again = live.still(eye=(389511, 5819650, 90))
            self.assertGreater(again.seq, seq)
            self.assertGreater(again.id, newest)
            self.assertEqual(live.session, before)
            self.assertEqual(again.jpeg, self.cloud.snapshot(format="jpg", eye=(389511, 5819650, 90), **SMALL).bytes)

    def test_many_threads_use_one_cloud(self):
        expected, wrong = self.cloud.snapshot(**SMALL).bytes, []

        def ask():
            for _ in range(3):
                if self.cloud.snapshot(**SMALL).bytes != expected:
                    wrong.append(1)

        threads = [threading.Thread(target=ask) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])


class ServerWithTls(support.Served):
    """TLS of an authority of its own, an access token, and a guest's link."""

    points = 2000

    @classmethod
    def flags(cls):
        cls.key, cls.certificate = os.path.join(cls.folder, "key.pem"), os.path.join(cls.folder, "certificate.pem")
        subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2", "-subj",
                        "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", cls.key, "-out", cls.certificate],
                       check=True, capture_output=True, timeout=support.PATIENCE)
        cls.tokens, cls.guests = os.path.join(cls.folder, "token"), os.path.join(cls.folder, "guest-keys")
        cls.token = secrets.token_urlsafe(32)
        with open(os.open(cls.tokens, os.O_WRONLY | os.O_CREAT, 0o600), "w") as file:
            file.write(cls.token + "\n")
        key = subprocess.run([os.path.join(support.PROGRAMS, "scancast"), "token", "guests"], check=True, capture_output=True, timeout=support.PATIENCE)
        with open(os.open(cls.guests, os.O_WRONLY | os.O_CREAT, 0o600), "wb") as file:
            file.write(key.stdout)
        return ["--tls-cert", cls.certificate, "--tls-key", cls.key, "--auth-token-file", cls.tokens, "--guest-key-file", cls.guests]

    def test_who_is_trusted_and_who_is_let_in(self):
        self.assertTrue(self.url.startswith("https://"))
        server = scancast.Server(self.url, token_file=self.tokens, ca_file=self.certificate)
        support.wait_until(lambda: server.ready() and server.clouds(), "the cloud is not there")
        cloud = server.cloud()
        with cloud.live(**SMALL) as live:
            threads = [threading.Thread(target=lambda: [live.view(fov=30 + i) for i in range(20)]) for _ in range(3)]
            for thread in threads:
                thread.start()
            for thread in threads:
                thread.join()
            self.assertEqual(live.still(fov=45).jpeg, cloud.snapshot(format="jpg", fov=45, **SMALL).bytes)
        with self.assertRaisesRegex(scancast.ConnectionFailed, "ca_file"):
            scancast.Server(self.url, token=self.token).clouds()
        with self.assertRaises(scancast.Unauthorized):
            scancast.Server(self.url, ca_file=self.certificate).clouds()
        with self.assertRaises(scancast.Unauthorized) as caught:
            scancast.Server(self.url, token="x" * 20, ca_file=self.certificate).cloud("town").live()
        self.assertNotIn("x" * 20, str(caught.exception))
        link = subprocess.run([os.path.join(support.PROGRAMS, "scancast"), "guest-link", "--key-file", self.guests, "--cloud", cloud.id, "--expires", "1h",
                               "--url", self.url + "/"], check=True, capture_output=True, text=True, timeout=support.PATIENCE).stdout.strip().splitlines()[-1]
        guest = scancast.Server(link, ca_file=self.certificate)
        self.assertEqual([one.id for one in guest.clouds()], [cloud.id])
        with guest.cloud().live(**SMALL) as live:
            self.assertTrue(live.still().final)
        self.assertRaises(scancast.NotFound, guest.cloud, "another")
        self.assertNotIn("guest", repr(guest) + repr(guest.cloud()))


class LyingServers(unittest.TestCase):
    """What comes is no Scancast server's: a sentence in every case, and no waiting."""

    def answered(self, answer, ask=lambda server: server.clouds(), **options):
        with support.lying(lambda connection: (support.request_head(connection), connection.sendall(answer))) as url:
            with self.assertRaises(scancast.ScancastError) as caught:
                ask(scancast.Server(url, timeout=support.PATIENCE, **options))
            return caught.exception

    def test_they_are_found_out(self):
        json_head = b"HTTP/1.1 200 OK\r\nContent-Type: application/json\r\nContent-Length: %d\r\n\r\n"
        for answer in (b"", b"nonsense\r\n\r\n", b"HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\n[]", json_head % 2 + b"{}", json_head % 4 + b"nope",
                       json_head % 13 + b'{"clouds": 1}', json_head % 16 + b'{"clouds": [{}]}', json_head % 200_000 + b"[" * 200_000,
                       b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nffffffffffffffff\r\nx"):
            self.assertIsInstance(self.answered(answer), scancast.BadAnswer, answer[:80])
        self.assertIn("is it a Scancast server?", str(self.answered(b"HTTP/1.1 302 x\r\nLocation: http://other/\r\nContent-Length: 0\r\n\r\n")))
        self.assertEqual(self.answered(b"HTTP/1.1 500 x\r\nContent-Type: application/problem+json\r\nContent-Length: 5\r\n\r\n[1,2]").status, 500)

    def test_who_is_asked_to_wait_waits_as_long_as_he_wants(self):
        busy = b"HTTP/1.1 503 x\r\nRetry-After: %d\r\nContent-Length: 0\r\n\r\n"
        answers = [busy % 0, busy % 0, b'HTTP/1.1 200 OK\r\nContent-Length: 29\r\n\r\n{"clouds": [], "pending": []}']
        with support.lying(lambda connection: (support.request_head(connection), connection.sendall(answers.pop(0)))) as url:
            self.assertEqual(scancast.Server(url, timeout=support.PATIENCE, patience=support.PATIENCE).clouds(), [])
        self.assertEqual(answers, [])
        self.assertEqual(self.answered(busy % 9999, patience=5).retry_after, 9999)
        self.assertIsInstance(self.answered(busy % 1), scancast.Unavailable)

    def test_more_than_a_picture_can_have_is_not_read(self):
        endless = b"HTTP/1.1 200 OK\r\nContent-Type: image/png\r\n\r\n" + bytes(3 << 20)
        there = object.__new__(facts.CloudFacts)
        object.__setattr__(there, "id", "town")
        for ask in (lambda one: one.snapshot(width=16, height=9), lambda one: one.pick(1, 1)):
            error = self.answered(endless, lambda server: ask(cloud.Cloud(server._transport, there)))
            self.assertIn("more than", str(error))

    @support.needs("numpy")
    def test_a_depth_of_another_size_is_none(self):
        with support.lying(lambda c: (support.request_head(c), c.sendall(
                b"HTTP/1.1 200 OK\r\nScancast-Width: 100000\r\nScancast-Height: 100000\r\nContent-Length: 4\r\n\r\nabcd"))) as url:
            there = object.__new__(facts.CloudFacts)
            object.__setattr__(there, "id", "a/../b")
            with self.assertRaises(scancast.BadAnswer):
                cloud.Cloud(scancast.Server(url)._transport, there).depth()


if __name__ == "__main__":
    unittest.main()
