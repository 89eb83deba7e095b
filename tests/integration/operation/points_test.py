"""`scancast-client points` and `profile` as people run them, against a server of the program, read back by nothing of ours; a
generated town, ingested exactly, is the oracle: regions and corridors by brute force over its points.

    points_test.py FOLDER_OF_THE_PROGRAMS
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

from point_files import csv_rows, in_polygon, ply_rows, read_csv, read_las, read_ply

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

PROGRAMS = os.path.abspath(sys.argv.pop())
POINTS = 20000


def program(name, *arguments, fails=False):
    done = subprocess.run([os.path.join(PROGRAMS, name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
    if (done.returncode != 0) != fails:
        raise AssertionError(f"{' '.join(arguments)} ended with {done.returncode}:\n{done.stderr.decode()[-2000:]}")
    return done


def nearest(line, x, y):
    """Distance, station, whether to the right, whether before the beginning or behind the end; of the nearest segment."""
    best, before = (math.inf,), 0
    for i, ((ax, ay), (bx, by)) in enumerate(zip(line, line[1:])):
        length = math.hypot(bx - ax, by - ay)
        share = ((x - ax) * (bx - ax) + (y - ay) * (by - ay)) / length ** 2
        held = min(1, max(0, share))
        distance = math.hypot(x - ax - held * (bx - ax), y - ay - held * (by - ay))
        if distance < best[0]:
            right = (bx - ax) * (y - ay) - (by - ay) * (x - ax) < 0
            beyond = i == 0 and share < 0 or i == len(line) - 2 and share > 1
            best = distance, before + held * length, right, beyond
        before += length
    return best


class Points(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        program("scancast", "generate", "town", "--points", str(POINTS), "-q", "-o", cls.path("town.las"))
        program("scancast", "ingest", cls.path("town.las"), "-q", "--exact", "--no-surfels", "-o", cls.path("town.scan"))
        with open(cls.path("town.las"), "rb") as file:
            cls.header, cls.points = read_las(file.read())
        cls.grid = cls.header["scale"], cls.header["offset"]
        log = open(cls.path("serve.log"), "wb")
        cls.addClassCleanup(log.close)
        cls.server = serving.Server(os.path.join(PROGRAMS, "scancast"), cls.path("town.scan"), 4, log)
        cls.addClassCleanup(cls.server.stop)
        cls.middle = [sum(cls.place(p)[a] for p in cls.points) / POINTS for a in range(3)]

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def place(cls, p):
        return [o + s * v for s, o, v in zip(*cls.grid, p[:3])]

    def client(self, command, name, *arguments, **options):
        done = program("scancast-client", command, self.server.url, "-o", self.path(name), *arguments, **options)
        if options.get("fails"):
            return done
        with open(self.path(name), "rb") as file:
            return file.read()

    def same(self, found, expected):
        self.assertEqual(sorted(found), sorted(expected))

    def test_everything_in_every_format(self):
        header, points = read_las(self.client("points", "all.las"))
        self.same(points, self.points)
        self.assertEqual(header["legacy"], POINTS)
        self.assertEqual(sum(header["returns"]), POINTS)
        self.same(read_ply(self.client("points", "all.ply"), *self.grid), self.points)
        self.same(read_csv(self.client("points", "all.csv").decode("ascii"), *self.grid), self.points)
        blanks = self.client("points", "all.xyz").decode("ascii")
        self.same(read_csv(blanks[2:].replace(" ", ","), *self.grid), self.points)

    def test_regions_are_what_brute_force_finds(self):
        x, y = self.middle[:2]
        star = [(x - 60, y - 50), (x + 70, y - 40), (x - 20, y + 60), (x - 5, y - 70), (x + 40, y + 50)]
        wanted = [p for p in self.points if in_polygon(star, *self.place(p)[:2]) and 35 <= self.place(p)[2] <= 50]
        self.assertTrue(0 < len(wanted) < POINTS)
        corners = ";".join(f"{a},{b}" for a, b in star)
        found = self.client("points", "star.las", "--polygon", corners, "--z", "35,50")
        self.same(read_las(found)[1], wanted)
        found = self.client("points", "star.csv", "--polygon", corners, "--z", "35,50", "--classes", "2,6")
        self.same(read_csv(found.decode(), *self.grid), [p for p in wanted if p.classification in (2, 6)])
        turn = math.radians(30)

        def in_box(p):
            dx, dy = self.place(p)[0] - x, self.place(p)[1] - y
            return abs(dx * math.cos(turn) + dy * math.sin(turn)) <= 30 and abs(dy * math.cos(turn) - dx * math.sin(turn)) <= 10

        found = self.client("points", "box.ply", "--clips", f"box:{x},{y},0,60,20,1000,30")
        self.same(read_ply(found, *self.grid), [p for p in self.points if in_box(p)])
        nothing = self.client("points", "none.las", "--z", "5000,6000", fails=True)
        self.assertIn(b"No point lies there", nothing.stderr)
        self.assertFalse(os.path.exists(self.path("none.las")))

    def test_a_profile_is_what_brute_force_finds(self):
        x, y = self.middle[:2]
        line = [(x - 80, y - 60), (x + 10, y - 40), (x + 20, y + 70), (x - 50, y + 20)]
        wanted = {}
        for p in self.points:
            distance, station, right, beyond = nearest(line, *self.place(p)[:2])
            self.assertGreater(abs(distance - 3), 1e-9, "nothing lies on the edge to within rounding")
            if distance < 3 and not beyond:
                wanted.setdefault(p, []).append((station, distance if right else -distance))
        flags = "--line", ";".join(f"{a},{b}" for a, b in line), "--width", "6"
        for name, rows, read in (("p.ply", ply_rows, read_ply), ("p.csv", lambda t: csv_rows(t.decode()), lambda t, *g: read_csv(t.decode(), *g))):
            data = self.client("profile", name, *flags)
            found = {}
            for point, row in zip(read(data, *self.grid), rows(data)):
                found.setdefault(point, []).append((row["station"], row["offset"]))
            self.assertEqual(found.keys(), wanted.keys())
            for point, places in wanted.items():
                for (station, offset), (s, o) in zip(sorted(places), sorted(found[point]), strict=True):
                    self.assertAlmostEqual(station, s, 6)
                    self.assertAlmostEqual(offset, o, 6)

    def test_its_picture_says_what_its_edges_are(self):
        x, y = self.middle[:2]
        line = [[x - 80, y], [x + 80, y]]
        body = json.dumps({"line": line, "width": 4, "format": "png", "picture": {"width": 400, "height": 100}})
        status, headers, png = self.server.get("/api/v1/clouds/town/profile", method="POST", body=body,
                                               headers={"Content-Type": "application/json"})
        self.assertEqual((status, headers["Content-Type"], png[:4]), (200, "image/png", b"\x89PNG"))
        facts = json.loads(headers["Scancast-Profile"])
        heights = [self.place(p)[2] for p in self.points if abs(self.place(p)[1] - y) <= 2 and abs(self.place(p)[0] - x) <= 80]
        self.assertEqual(facts["points"], len(heights))
        for found, expected in zip(facts["heights"], (min(heights), max(heights))):
            self.assertAlmostEqual(found, expected, 6)
        self.assertAlmostEqual(facts["length"], 160)
        self.assertAlmostEqual(facts["right"], 160)
        self.assertAlmostEqual(facts["bottom"], min(heights))
        self.assertEqual(self.client("profile", "p.png", "--line", f"{x - 80},{y};{x + 80},{y}", "--width", "4",
                                     "--picture-width", "400", "--picture-height", "100"), png)


if __name__ == "__main__":
    unittest.main()
