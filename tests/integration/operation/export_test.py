"""`scancast export` as people run it, read back by nothing of ours (point_files.py); a generated town, ingested exactly, is the oracle.

    export_test.py FOLDER_OF_THE_PROGRAMS
"""
import os
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

from point_files import in_polygon, read_csv, read_las, read_ply

PROGRAMS = os.path.abspath(sys.argv.pop())
POINTS = 20000


def run(*arguments, fails=False, **options):
    done = subprocess.run([os.path.join(PROGRAMS, "scancast"), *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, timeout=300, **options)
    if (done.returncode != 0) != fails:
        raise AssertionError(f"{' '.join(arguments)} ended with {done.returncode}:\n{done.stderr.decode()[-2000:]}")
    return done


class Export(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.scan, cls.cloud = cls.path("town.las"), cls.path("town.scan")
        run("generate", "town", "--points", str(POINTS), "-q", "-o", cls.scan)
        run("ingest", cls.scan, "-q", "--exact", "--no-surfels", "-o", cls.cloud)
        with open(cls.scan, "rb") as file:
            cls.header, cls.points = read_las(file.read())

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def written(self, name, *arguments):
        run("export", self.cloud, "-f", "-q", "-o", self.path(name), *arguments)
        with open(self.path(name), "rb") as file:
            return file.read()

    def same(self, found, expected=None):
        self.assertEqual(sorted(found), sorted(self.points if expected is None else expected))

    def test_las(self):
        header, points = read_las(self.written("out.las"))
        self.same(points)
        self.assertEqual((header["minor"], header["format"]), (4, self.header["format"]))
        self.assertEqual((header["scale"], header["offset"]), (self.header["scale"], self.header["offset"]))
        self.assertEqual(header["legacy"], POINTS)
        self.assertEqual(sum(header["returns"]), POINTS)
        for axis in range(3):
            values = [header["offset"][axis] + header["scale"][axis] * p[axis] for p in points]
            self.assertAlmostEqual(header["bounds"][2 * axis], max(values), 6)
            self.assertAlmostEqual(header["bounds"][2 * axis + 1], min(values), 6)

    def test_ply_and_text(self):
        grid = self.header["scale"], self.header["offset"]
        self.same(read_ply(self.written("out.ply"), *grid))
        self.same(read_csv(self.written("out.csv").decode("ascii"), *grid))
        blanks = self.written("out.xyz").decode("ascii")
        self.assertTrue(blanks.startswith("//x y z red"))
        self.same(read_csv(blanks[2:].replace(" ", ","), *grid))

    def test_a_box_and_classes_are_what_brute_force_finds(self):
        scale, origin = self.header["scale"], self.header["offset"]
        middle = [sum(o + s * p[a] for p in self.points) / POINTS for a, s, o in zip(range(3), scale, origin)]
        low, high = [middle[0] - 40, middle[1] - 30, -1e3], [middle[0] + 25, middle[1] + 60, 1e3]
        box = ",".join(map(str, low + high))

        def inside(p):
            return all(l <= o + s * v <= h for l, h, s, o, v in zip(low, high, scale, origin, p[:3]))

        wanted = [p for p in self.points if inside(p)]
        self.assertTrue(0 < len(wanted) < POINTS)
        triangle = [(low[0], low[1]), (high[0], low[1] + 10), (middle[0], high[1])]
        flat = [p for p in self.points if in_polygon(triangle, *(o + s * v for s, o, v in zip(scale, origin, p[:2])))
                and 35 <= origin[2] + scale[2] * p.z <= 50]
        self.assertTrue(0 < len(flat) < POINTS)
        self.same(read_las(self.written("polygon.las", "--polygon", ";".join(f"{x},{y}" for x, y in triangle), "--z", "35,50"))[1],
                  flat)
        for flag in ("--clip", "--box"):
            self.same(read_las(self.written("part.las", flag, box))[1], wanted)
        self.same(read_ply(self.written("part.ply", "--clip", box, "--classes", "2,6"), scale, origin),
                  [p for p in wanted if p.classification in (2, 6)])
        self.assertIn(b"clip", run("export", self.cloud, "-o", self.path("x.las"), "--clip", "1,2,3", fails=True).stderr)
        nothing = run("export", self.cloud, "-o", self.path("x.las"), "--clip", "0,0,0,1,1,1", fails=True)
        self.assertIn(b"No point lies there", nothing.stderr)
        self.assertFalse(os.path.exists(self.path("x.las")))

    def test_standard_output_has_the_bytes_of_the_file(self):
        for form in ("las", "ply", "csv"):
            there = self.written(f"there.{form}")
            self.assertEqual(run("export", self.cloud, "-q", "-o", "-", "--format", form).stdout, there)
        self.assertIn(b"--format", run("export", self.cloud, "-o", "-", fails=True).stderr)

    def test_a_scan_comes_out_without_a_cloud_file(self):
        run("export", self.scan, "-q", "-o", self.path("again.las"))
        with open(self.path("again.las"), "rb") as file:
            header, points = read_las(file.read())
        self.assertEqual(points, self.points)
        self.assertEqual(header["scale"], self.header["scale"])

    def test_what_is_lost_is_told(self):
        run("ingest", self.scan, "-q", "--no-surfels", "-o", self.path("plain.scan"))
        told = run("export", self.path("plain.scan"), "-o", self.path("plain.las")).stderr.decode()
        self.assertIn("8 bits a channel", told)
        self.assertIn("--keep-attributes", told)
        self.assertNotIn("Not as the scan was", run("export", self.cloud, "-f", "-o", self.path("e.las")).stderr.decode())

    def test_what_nobody_writes_is_refused_with_a_way_out(self):
        refused = run("export", self.cloud, "-o", self.path("out.laz"), fails=True)
        self.assertIn(b"pdal translate", refused.stderr)
        self.assertFalse(os.path.exists(self.path("out.laz")))
        self.written("there.las")
        self.assertIn(b"--force", run("export", self.cloud, "-o", self.path("there.las"), fails=True).stderr)
        self.assertIn(b"both input and output", run("export", self.cloud, "-f", "-o", self.cloud, "--format", "las",
                                                    fails=True).stderr)

    def test_a_full_disk_leaves_nothing(self):
        def small_disk():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))

        before = sorted(os.listdir(self.folder))
        for name in ("full.las", "full.ply", "full.csv"):
            full = run("export", self.cloud, "-o", self.path(name), fails=True, preexec_fn=small_disk)
            self.assertIn(name.encode(), full.stderr)
        self.assertEqual(sorted(os.listdir(self.folder)), before)


if __name__ == "__main__":
    unittest.main()
