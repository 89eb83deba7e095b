"""scancast distance as people use it, its result read by Python alone.

Two scans become cloud files, distances are measured, and both clouds are exported as text: what the new one has beside the distances
is what the old one had, and each distance is that to the nearest of all points, found here by a grid.

Usage: distance_test.py BIN_DIRECTORY
"""

import csv
import itertools
import math
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest

SCANCAST = None
POINTS = 6000


def run(folder, *arguments, code=0):
    done = subprocess.run([SCANCAST, *arguments], cwd=folder, capture_output=True, text=True, timeout=120)
    assert done.returncode == code, f"{arguments}: {done.returncode}\n{done.stderr}"
    return done


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def place(row):
    return float(row["x"]), float(row["y"]), float(row["z"])


class Grid:
    """Points by cells of one size: what is nearer than a cell lies in the cells around."""

    def __init__(self, points, size):
        self.size, self.cells = size, {}
        for point in points:
            self.cells.setdefault(self.cell(point), []).append(point)

    def cell(self, point):
        return tuple(math.floor(c / self.size) for c in point)

    def nearest(self, point):
        """The distance, or None where it is more than a cell."""
        centre, best = self.cell(point), None
        for step in itertools.product((-1, 0, 1), repeat=3):
            for other in self.cells.get(tuple(a + b for a, b in zip(centre, step)), ()):
                far = math.dist(point, other)
                if best is None or far < best:
                    best = far
        return best if best is not None and best < self.size else None


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


class Distance(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = folder = pathlib.Path(cls.temporary.name)
        for name, seed in (("before", "1"), ("after", "2")):
            run(folder, "generate", "town", "--points", str(POINTS), "--seed", seed, "-q", "-o", f"{name}.las")
            run(folder, "ingest", f"{name}.las", "-o", f"{name}.scan", "--exact", "-q")
        run(folder, "label", "after.scan", "--attribution", "Nobody", "--recorded", "2024")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def exported(self, name):
        run(self.folder, "export", f"{name}.scan", "-o", f"{name}.csv", "-f", "-q")
        return rows_of(self.folder / f"{name}.csv")

    def check(self, most, shift=(0, 0, 0)):
        before, after, out = (self.exported(name) for name in ("before", "after", "out"))
        grid = Grid([tuple(a + b for a, b in zip(place(row), shift)) for row in before], most)
        self.assertEqual(len(out), len(after))
        within = 0
        for new, old in zip(out, after):
            distance = float(new.pop("distance"))
            self.assertEqual(new, old)
            nearest = grid.nearest(place(old))
            within += nearest is not None
            self.assertAlmostEqual(distance, float32(most if nearest is None else nearest), delta=1e-6)
        return within

    def test_distances_are_those_to_the_nearest_of_all_points(self):
        done = run(self.folder, "distance", "after.scan", "before.scan", "-o", "out.scan", "-f")
        self.assertIn("column distance: half of the points are within ", done.stderr)
        self.assertIn(f"{POINTS} points", done.stderr)
        self.assertGreater(self.check(5), POINTS * 0.8)
        label = run(self.folder, "label", "out.scan").stdout
        self.assertEqual(label, run(self.folder, "label", "after.scan").stdout)
        self.assertEqual(run(self.folder, "look", "out.scan").stdout,
                         run(self.folder, "look", "after.scan").stdout)
        run(self.folder, "info", "--check", "out.scan")

    def test_with_a_shift_and_a_limit_and_any_room(self):
        arguments = ["distance", "after.scan", "before.scan", "--max", "1.5", "--shift", "-0.5,0.25,0.125", "-q"]
        run(self.folder, *arguments, "-o", "out.scan", "-f")
        within = self.check(1.5, (-0.5, 0.25, 0.125))
        self.assertGreater(within, 100)
        self.assertLess(within, POINTS)
        run(self.folder, *arguments, "-o", "small.scan", "-f", "--threads", "1", "--memory-limit", "256M")
        self.assertEqual((self.folder / "small.scan").read_bytes(), (self.folder / "out.scan").read_bytes())

    def test_what_cannot_be_done_is_said_and_leaves_nothing(self):
        before = sorted(self.folder.iterdir())
        for arguments, words in (
            (["after.scan", "nothing.scan", "-o", "no.scan"], "nothing.scan"),
            (["after.las", "before.scan", "-o", "no.scan"], "scancast ingest after.las"),
            (["after.scan", "before.las", "-o", "no.scan"], "scancast ingest before.las"),
            (["after.scan", "after.scan", "-o", "no.scan"], "every distance would be 0"),
            (["after.scan", "before.scan", "-o", "after.scan"], "--force"),
            (["after.scan", "before.scan", "-o", "after.scan", "--force"], "both input and output"),
            (["after.scan", "before.scan", "-o", "no.scan", "--max", "-1"], "above 0"),
            (["after.scan", "before.scan", "-o", "no.scan", "--shift", "1,2"], "--shift"),
            (["after.scan", "before.scan", "-o", "no.scan", "--name", "a:b"], "letters, digits"),
            (["after.scan", "before.scan", "-o", "no.scan", "--memory-limit", "1M"], "256M"),
            (["https://example.org/a.scan", "before.scan", "-o", "no.scan"], "download"),
        ):
            done = run(self.folder, "distance", *arguments, code=1)
            self.assertIn(words, done.stderr)
            self.assertTrue(done.stderr.startswith("scancast distance: "), done.stderr)
        self.assertEqual(sorted(self.folder.iterdir()), before)

    def test_systems_that_differ_are_refused(self):
        for name, crs in (("a", "EPSG:25832"), ("b", "EPSG:25833")):
            run(self.folder, "ingest", "after.las", "-o", f"{name}.scan", "--assume-crs", crs, "-q", "-f")
        done = run(self.folder, "distance", "a.scan", "b.scan", "-o", "no.scan", code=1)
        for word in ("EPSG:25832", "EPSG:25833", "different coordinate reference systems"):
            self.assertIn(word, done.stderr)
        done = run(self.folder, "distance", "a.scan", "before.scan", "-o", "one.scan")
        self.assertIn("does not say its coordinate reference system", done.stderr)
        self.assertIn("metre", run(self.folder, "info", "one.scan").stdout)

    def test_interrupted_it_leaves_nothing(self):
        run(self.folder, "generate", "town", "--points", "500k", "-q", "-o", "large.las")
        run(self.folder, "ingest", "large.las", "-o", "large.scan", "--no-surfels", "-q")
        before = sorted(self.folder.iterdir())
        process = subprocess.Popen([SCANCAST, "distance", "large.scan", "before.scan", "-o", "stopped.scan", "--threads", "1"],
                                   cwd=self.folder, stderr=subprocess.PIPE, text=True)
        # It has begun to write, so it listens to signals; what it measures takes it much longer than a look.
        end = time.monotonic() + 60
        while not (self.folder / "stopped.scan.partial").exists() and time.monotonic() < end:
            time.sleep(0.001)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1, error)
        self.assertIn("Interrupted; no cloud file was left behind.", error)
        self.assertEqual(sorted(self.folder.iterdir()), before, error)


if __name__ == "__main__":
    SCANCAST = str(pathlib.Path(sys.argv.pop(1)) / "scancast")
    unittest.main()
