"""A cloud file by ranks has the bytes of one process' file, and where a rank fails there is none.

    ingest_test.py FOLDER_OF_THE_PROGRAMS FOLDER_OF_THE_TEST_PROGRAMS FOLDER_OF_REAL_SCANS
"""
import filecmp
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from by_mpirun import by_ranks

REAL = os.path.abspath(sys.argv.pop())
TESTS = os.path.abspath(sys.argv.pop())
PROGRAMS = os.path.abspath(sys.argv.pop())
PATIENCE = 120  # seconds; only a hang takes so long


class Ingest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.home = tempfile.TemporaryDirectory()
        for name, points, seed, format in (("a.las", "9k", "1", "las"), ("b.las", "6k", "2", "las14")):
            subprocess.run([os.path.join(PROGRAMS, "scancast"), "generate", "town", "--points", points, "--seed", seed, "--format", format,
                            "-q", "-o", cls.path(name)], check=True, timeout=PATIENCE)
        with open(cls.path("c.xyz"), "w") as file:
            file.writelines(f"{500 + i % 50 * 0.25} {i // 50 * 0.25} {i % 7 * 0.01}\n" for i in range(3000))

    @classmethod
    def tearDownClass(cls):
        cls.home.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.home.name, name)

    def run_one(self, *arguments):
        return subprocess.run([os.path.join(PROGRAMS, "scancast"), *arguments], timeout=PATIENCE, capture_output=True, text=True)

    def run_ranks(self, count, *arguments):
        return subprocess.run(by_ranks(count, os.path.join(PROGRAMS, "scancast-ranks"), *arguments), timeout=PATIENCE,
                              capture_output=True, text=True)

    def clouds(self):
        return sorted(name for name in os.listdir(self.home.name) if ".scan" in name)

    def tearDown(self):
        for name in self.clouds():
            os.remove(self.path(name))


class TheSameBytes(Ingest):
    def test_of_many_chunks_in_every_shape(self):
        for count in (1, 2, 3, 4):
            with self.subTest(ranks=count):
                self.same_in_every_shape(count, self.path("a.las"), self.path("b.las"))

    def test_of_a_real_scan(self):
        scan = os.path.join(REAL, "las", "las10-pdrf0.las")
        if not os.path.exists(scan):
            self.skipTest(f"{scan} is missing")
        self.same_in_every_shape(3, scan)

    def same_in_every_shape(self, count, *scans):
        done = subprocess.run(by_ranks(count, os.path.join(TESTS, "ingest_by_ranks"), self.home.name, *scans), timeout=PATIENCE,
                              capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertEqual(8, done.stdout.count("the same bytes"), done.stdout)

    def test_of_the_program_with_its_look(self):
        files = [self.path("a.las"), self.path("c.xyz")]
        flags = ["--assume-crs", "EPSG:25832", "--attribution", "City of Graz, CC BY 4.0", "-q", "--title", "T"]
        one = self.run_one("ingest", *files, *flags, "-o", self.path("one.scan"))
        self.assertEqual(0, one.returncode, one.stderr)
        many = self.run_ranks(2, "ingest", *files, *flags, "-o", self.path("many.scan"))
        self.assertEqual((0, ""), (many.returncode, many.stderr))
        self.assertTrue(filecmp.cmp(self.path("one.scan"), self.path("many.scan"), shallow=False))


class WhatGoesWrong(Ingest):
    def test_a_broken_scan_ends_all_with_one_sentence(self):
        with open(self.path("c.xyz")) as good, open(self.path("broken.xyz"), "w") as bad:
            bad.write(good.read() + "1 2 oops\n")
        done = self.run_ranks(3, "ingest", self.path("a.las"), self.path("b.las"), self.path("broken.xyz"), "-q", "-o", self.path("x.scan"))
        self.assertEqual(1, done.returncode)
        self.assertEqual(1, done.stderr.count("scancast-ranks ingest:"), done.stderr)
        self.assertIn("broken.xyz, line 3,001", done.stderr)
        self.assertEqual([], self.clouds())

    def test_a_folder_that_is_not_there_is_told_before_anything_is_read(self):
        done = self.run_ranks(2, "ingest", self.path("a.las"), "-q", "-o", self.path("nowhere/x.scan"))
        self.assertEqual(1, done.returncode)
        self.assertEqual(1, done.stderr.count("the folder is not there"), done.stderr)

    def test_standard_input_is_nobodys(self):
        done = self.run_ranks(2, "ingest", "-", "-q", "-o", self.path("x.scan"))
        self.assertEqual(1, done.returncode)
        self.assertIn("cannot share standard input", done.stderr)

    def test_a_wrong_command_line_is_told_once(self):
        done = self.run_ranks(3, "ingest", self.path("a.las"), "--nonsense", "-o", self.path("x.scan"))
        self.assertEqual(2, done.returncode)
        self.assertEqual(1, done.stderr.count("--nonsense"), done.stderr)

    def test_a_killed_rank_ends_all_and_leaves_nothing(self):
        # So large that it is not done before.
        made = self.run_one("generate", "town", "--points", "800k", "-q", "-o", self.path("big.las"))
        self.assertEqual(0, made.returncode, made.stderr)
        job = subprocess.Popen(by_ranks(2, os.path.join(PROGRAMS, "scancast-ranks"), "ingest", self.path("big.las"), "-q", "-o", self.path("x.scan")),
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.kill(self.rank_of(job.pid), signal.SIGKILL)
        self.assertNotEqual(0, job.wait(timeout=PATIENCE))
        self.assertEqual([], self.clouds())

    def rank_of(self, job):
        """The process that is rank 1, once it is one."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            for pid in filter(str.isdigit, os.listdir("/proc")):
                try:
                    with open(f"/proc/{pid}/environ", "rb") as file:
                        environment = file.read().split(b"\0")
                    with open(f"/proc/{pid}/stat") as file:
                        parent = int(file.read().rsplit(")", 1)[1].split()[1])
                except OSError:
                    continue
                if b"OMPI_COMM_WORLD_RANK=1" in environment and parent == job:
                    return int(pid)
            time.sleep(0.01)
        self.fail("there is no rank 1")


if __name__ == "__main__":
    unittest.main()
