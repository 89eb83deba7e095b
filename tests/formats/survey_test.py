"""The survey of formats sees what it is there to see: its own readers count rightly, whoever answers wrongly is found out,
and scancast agrees with them about files that are made here.

    survey_test.py FOLDER_OF_THE_PROGRAMS
"""
import contextlib
import io
import os
import subprocess
import sys
import tempfile
import unittest

import samples
import survey
from declared.examine import examine
from declared.pcd import unpacked

PROGRAMS = os.path.abspath(sys.argv.pop())
BOUNDS = (samples.POINTS[0][0], samples.POINTS[0][1], samples.POINTS[-1][2]), (*samples.POINTS[-1][:2], samples.POINTS[0][2])

# Answers by the file's name: what a program may do wrong, and a refusal and an answer that are in order.
LIAR = """#!/usr/bin/env python3
import json, os, signal, sys, time
path = sys.argv[-1]
name = os.path.basename(path)
def answer(code=0, **facts):
    print(json.dumps({"files": [{"file": path, **facts}]}))
    sys.exit(code)
right = dict(points=39, droppedPoints=1, bounds=BOUNDS, notes=[], classes=[], attributes={"intensity": False})
if "crash" in name: os.kill(os.getpid(), signal.SIGSEGV)
if "hang" in name: time.sleep(60)
if "babble" in name: print("Hello"); sys.exit(0)
if "silent" in name: answer(1, error={"code": "io", "message": path})
if "importer" in name: answer(1, error={"code": "importer", "message": path + ": scancast-import-x crashed (signal 11)"})
if "refused" in name: answer(1, error={"code": "malformed", "message": path + ", byte 3: it has 12 points too few. Scancast reads X."})
if "lost" in name: answer(**{**right, "droppedPoints": 0})
if "moved" in name: answer(**{**right, "bounds": [[0, 0, 0], [1, 1, 1]]})
answer(**right)
"""


def surveyed(folder, program, *flags):
    """(exit code, what was printed)"""
    said = io.StringIO()
    sys.argv = ["survey.py", folder, "--scancast", program, *flags]
    with contextlib.redirect_stdout(said):
        code = survey.main()
    return code, said.getvalue()


def row(said, name):
    cells = next(line for line in said.splitlines() if line.startswith(f"| {name} |")).strip("| ").split(" | ")
    return dict(zip(["tried", "read", "equal", "different", "uncounted", "refused", "whole", "faults"], map(int, cells[1:9])))


class Declared(unittest.TestCase):
    """The readers of survey.py, over files whose points are known."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def look(self, name, content):
        return examine(samples.save(self.folder, name, content))

    def test_counts_and_bounds(self):
        places = {f"{e}.ply": samples.ply(e) for e in ("ascii", "binary_little_endian", "binary_big_endian")}
        places |= {f"{e}.pcd": samples.pcd(e) for e in ("ascii", "binary", "binary_compressed")}
        places |= {"a.las": samples.las(), "a.xyz": samples.rows(samples.POINTS),
                   "a.csv": "y,z,x\n" + samples.rows([(y, z, x) for x, y, z in samples.POINTS], "{},{},{}\n"),
                   "a.asc": "// x; y; z\n" + samples.rows(samples.POINTS, "{};{};{}\n").replace(".", ","),
                   "a.pts": f"{len(samples.POINTS)}\n" + samples.rows(samples.POINTS),
                   "a.obj": samples.rows(samples.POINTS, "v {} {} {}\n") + "vn 1 0 0\nf 1 2 3\n"}
        for name, content in places.items():
            with self.subTest(name):
                found = self.look(name, content)
                self.assertEqual((found.points, found.broken), (len(samples.POINTS), ""))
                self.assertTrue(survey.alike(found.bounds, BOUNDS, 1e-6), found.bounds)

    def test_what_else_records_of_las_hold(self):
        found = self.look("a.las", samples.las())
        self.assertEqual((found.intensity, found.classes), ((100, 139), {0: 14, 1: 13, 2: 13}))

    def test_ptx_moves_its_points_and_knows_directions_without_echo(self):
        found = self.look("a.ptx", samples.ptx())
        self.assertEqual((found.format, found.points, found.bounds[0]), ("PTX", 40, (100.25, 200.5, 260.0)))

    def test_scans_of_e57_stand_where_their_poses_say(self):
        found = self.look("a.e57", samples.e57())
        turned = [(100 - y, x, z) for x, y, z in samples.POINTS[20:]]  # by hand: a quarter turn takes x to y, and y to -x
        expected = [tuple(pick(p[axis] for p in samples.POINTS[:20] + turned) for axis in range(3)) for pick in (min, max)]
        self.assertEqual((found.points, found.broken), (40, ""))
        self.assertTrue(survey.alike(found.bounds, expected, 1e-6), found.bounds)

    def test_sums_of_parts(self):
        for make in (samples.ept, samples.potree2):
            found = examine(make(os.path.join(self.folder, make.__name__)))
            self.assertEqual((found.points, found.broken), (12, ""))

    def test_what_is_broken_is_called_so(self):
        broken = {"a.ply": samples.ply("ascii", promised=99), "b.ply": samples.ply("binary_little_endian", promised=99),
                  "a.las": samples.las(kept=30), "a.pcd": samples.pcd("binary")[:-1], "c.pcd": samples.pcd("binary_compressed")[:-1],
                  "a.e57": samples.e57()[:-300] + bytes(300), "a.txt": "1 2 3\n1 2\n", "b.txt": "Dear reader,\n", "a.pts": "9\n1 2 3\n"}
        for name, content in broken.items():
            with self.subTest(name):
                self.assertNotEqual(self.look(name, content).broken, "")
        self.assertNotEqual(examine(samples.ept(os.path.join(self.folder, "ept"), said=13)).broken, "")

    def test_references_in_compressed_points(self):
        self.assertEqual(unpacked(b"\x02abc" + b"\x20\x02" + b"\xe0\x01\x00", 16), b"abc" + b"abc" + b"c" * 10)


class Answers(unittest.TestCase):
    """Who answers wrongly is found out."""

    def judged(self, name, **more):
        with tempfile.TemporaryDirectory() as folder:
            program = samples.save(folder, "liar", LIAR.replace("BOUNDS", repr(BOUNDS)))
            os.chmod(program, 0o755)
            samples.save(folder, f"scans/{name}", samples.ply("ascii"))
            code, said = surveyed(os.path.join(folder, "scans"), program, "--timeout", more.get("timeout", "30"))
            return code, row(said, "PLY"), said

    def test_equal_counts_those_that_were_dropped_and_told(self):
        code, counts, _ = self.judged("right.ply")
        self.assertEqual((code, counts["equal"], counts["read"]), (0, 1, 1))

    def test_lost_and_moved_points(self):
        for name in ("lost.ply", "moved.ply"):
            code, counts, said = self.judged(name)
            self.assertEqual((code, counts["different"]), (1, 1), said)

    def test_a_refusal_is_in_order_and_its_sentence_told(self):
        code, counts, said = self.judged("refused.ply")
        self.assertEqual((code, counts["refused"], counts["whole"]), (0, 1, 1))
        self.assertIn("| PLY: it has 12 points too few. | 1 | refused.ply |", said)

    def test_faults(self):
        for name in ("crash.ply", "babble.ply", "silent.ply", "importer.ply", "hang.ply"):
            code, counts, said = self.judged(name, timeout="0.5" if name == "hang.ply" else "30")
            self.assertEqual((code, counts["faults"]), (1, 1), said)

    def test_the_same_content_is_tried_once(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.ply", "b/c.ply", "kept/out.ply"):
                samples.save(folder, name, samples.ply("ascii"))
            samples.save(folder, "kept/other.ply", samples.ply("ascii", samples.POINTS[:9]))
            self.assertEqual(len(list(survey.found_in(folder, []))), 2)
            self.assertEqual(len(list(survey.found_in(folder, ["kept"]))), 1)


class Scancast(unittest.TestCase):
    """scancast itself, over files made here and by itself."""

    def test_agrees(self):
        program = os.path.join(PROGRAMS, "scancast")
        with tempfile.TemporaryDirectory() as folder:
            for name, form in (("town.las", "las14"), ("sphere.las", "las"), ("sphere.ply", "ply")):
                subprocess.run([program, "generate", name.split(".")[0], "--points", "3k", "--format", form, "--quiet",
                                "-o", os.path.join(folder, name)], check=True, timeout=300)
            files = {"a.las": samples.las(), "cut.las": samples.las(kept=3), "a.xyz": samples.rows(samples.POINTS),
                     "a.ptx": samples.ptx(), "cut.ptx": samples.ptx()[:-300], "a.txt": "Dear reader,\nno point.\n"}
            for name, content in files.items():
                samples.save(folder, name, content)
            code, said = surveyed(folder, program, "--memory", "0", "--timeout", "300")
            self.assertEqual(code, 0, said)
            self.assertEqual([row(said, "LAS")[k] for k in ("tried", "equal", "refused", "whole")], [4, 3, 1, 0], said)
            self.assertEqual([row(said, "PTX")[k] for k in ("tried", "equal", "refused", "whole")], [2, 1, 1, 0], said)
            self.assertEqual([row(said, "text")[k] for k in ("tried", "equal", "refused", "whole")], [2, 1, 1, 0], said)


if __name__ == "__main__":
    unittest.main(verbosity=2)
