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
from by_mpirun import by_ranks, by_unlike_ranks
from small_las import las

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

    def small(self, name, *arguments, **keywords):
        las(self.path(name), *arguments, **keywords)
        return self.path(name)

    def clouds(self):
        return sorted(name for name in os.listdir(self.home.name) if ".scan" in name)

    def tearDown(self):
        for name in self.clouds():
            os.remove(self.path(name))


WEST, EAST = ('PROJCS["WGS 84 / UTM zone %dN",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],PRIMEM["Greenwich",0],'
              'UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["central_meridian",%d],PARAMETER["scale_factor",0.9996],'
              'PARAMETER["false_easting",500000],UNIT["metre",1],AUTHORITY["EPSG","326%d"]]' % zone for zone in ((32, 9, 32), (33, 15, 33)))


class TheSameBytes(Ingest):
    def test_of_many_chunks_and_all_kinds_of_scans(self):
        # Where a unit in the last place of a coordinate shows in what is stored.
        far, fine = (412345.37, 312345.91, 271.13), [1e-6] * 3
        groups = [
            [self.path("a.las"), self.path("b.las")],
            # Steps that are whole ones apart, and such that are not: which of them a rank has read decides nothing.
            [self.small("grid.las", 1500, 3, fine, far), self.small("beside.las", 1500, 4, fine, (far[0] + 4e-7, far[1] + 3e-7, far[2])),
             self.small("moved.las", 1500, 5, fine, (far[0] + 0.001234, far[1] - 0.000789, far[2] + 0.000001))],
            # Near infrared of 16 bits, of 8, and none.
            [self.small("infrared.las", 2000, 7, infrared=65535), self.small("dark.las", 1000, 8, infrared=200), self.small("none.las", 700, 15)],
            # Colours of 8 bits.
            [self.small("colors.las", 3000, 9, colors=255), self.small("more.las", 500, 10, colors=255)],
            # Fewer points than ranks; no grid in common.
            [self.small("few.las", 3, 11)],
            [self.small("coarse.las", 500, 6, [0.1] * 3), self.small("less.las", 1200, 16)],
            # Refused, once all is read or before.
            [self.path("a.las"), self.small("infinite.las", 700, 12, scale=(1e308, 1e308, 1e308))],
            [self.small("west.las", 300, 13, wkt=WEST), self.small("east.las", 300, 14, wkt=EAST)],
        ]
        for count in (1, 2, 3, 4):
            with self.subTest(ranks=count):
                self.same(count, groups, bytes=8 + 2 * 5, refusals=2 * 2)

    def test_of_a_real_scan(self):
        scan = os.path.join(REAL, "las", "las10-pdrf0.las")
        if not os.path.exists(scan):
            self.skipTest(f"{scan} is missing")
        self.same(3, [[scan]], bytes=8, refusals=0)

    def same(self, count, groups, bytes, refusals):
        scans = [word for group in groups for word in ["--", *group]][1:]
        done = subprocess.run(by_ranks(count, os.path.join(TESTS, "ingest_by_ranks"), self.home.name, *scans), timeout=PATIENCE,
                              capture_output=True, text=True)
        self.assertEqual(0, done.returncode, done.stdout + done.stderr)
        self.assertEqual((bytes, refusals), (done.stdout.count("the same bytes"), done.stdout.count("the same refusal")), done.stdout)

    def test_of_stations_and_photos(self):
        scan = os.path.join(REAL, "e57", "tiny_pc_and_images.e57")
        if not os.path.exists(scan):
            self.skipTest(f"{scan} is missing")
        self.same_by_the_program(3, scan, self.path("c.xyz"), self.path("a.las"), "--title", "T", "--assume-crs", "EPSG:25832")

    def same_by_the_program(self, count, *arguments):
        one = self.run_one("ingest", *arguments, "-o", self.path("one.scan"))
        self.assertEqual(0, one.returncode, one.stderr)
        many = self.run_ranks(count, "ingest", *arguments, "-o", self.path("many.scan"))
        self.assertEqual(0, many.returncode, many.stderr)
        self.assertTrue(filecmp.cmp(self.path("one.scan"), self.path("many.scan"), shallow=False))
        # What is said of it, but for its name, what it needs and how long it took; progress is of rank 0's share.
        other = (" s (", " s)", "will need up to", " %  ")
        said = [[line for line in text.splitlines() if not any(words in line for words in other)] for text in (one.stderr, many.stderr)]
        self.assertEqual(*said)

    def test_of_what_is_whole_of_a_scan_that_ends_too_early(self):
        short = self.cut("a.las", 100_000)
        self.same_by_the_program(2, short, self.path("c.xyz"), "--recover", "--title", "T", "--assume-crs", "EPSG:25832")

    def cut(self, name, bytes):
        with open(self.path(name), "rb") as file, open(self.path("short.las"), "wb") as short:
            short.write(file.read(bytes))
        return self.path("short.las")

    def test_of_a_scan_with_something_behind_it(self):
        with open(self.path("a.las"), "rb") as file, open(self.path("long.las"), "wb") as longer:
            longer.write(file.read() + bytes(1000))
        self.same_by_the_program(2, self.path("long.las"), "--no-surfels", "--title", "T")

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

    def test_what_one_process_refuses(self):
        with open(self.path("a.las"), "rb") as file, open(self.path("short.las"), "wb") as short:
            short.write(file.read(100_000))
        for broken in (self.path("short.las"), self.small("none.las", 0)):
            with self.subTest(scan=os.path.basename(broken)):
                sentences = []
                for run, count in ((self.run_one, ()), (self.run_ranks, (2,))):
                    done = run(*count, "ingest", self.path("b.las"), broken, "-q", "-o", self.path("x.scan"))
                    self.assertEqual(1, done.returncode)
                    sentences.append(done.stderr.replace("scancast-ranks ", "scancast "))
                self.assertEqual(*sentences)
                self.assertEqual([], self.clouds())

    def test_a_rank_that_does_not_see_the_scans_is_named(self):
        """And nobody waits for it: only a hang would take PATIENCE."""
        os.makedirs(self.path("elsewhere"), exist_ok=True)
        done = self.run_unlike(self.home.name, self.path("elsewhere"))
        self.assertEqual(1, done.returncode)
        self.assertEqual(1, done.stderr.count("scancast-ranks ingest:"), done.stderr)
        self.assertIn("Rank 1 of 2, on ", done.stderr)
        self.assertIn("seen.las", done.stderr)

    def test_a_rank_that_sees_another_scan_of_the_name_ends_all(self):
        os.makedirs(self.path("other"), exist_ok=True)
        # As many points, of the same kind, on the same grid: only elsewhere.
        las(self.path("other/seen.las"), 400, 99)
        done = self.run_unlike(self.home.name, self.path("other"))
        self.assertEqual(1, done.returncode)
        self.assertEqual(1, done.stderr.count("do not see the same scans"), done.stderr)
        self.assertEqual([], self.clouds())

    def test_ranks_with_other_options_end_all(self):
        scan = self.small("seen.las", 400)
        program = [os.path.join(PROGRAMS, "scancast-ranks"), "ingest", scan, "-q", "-o", self.path("x.scan")]
        done = subprocess.run(by_unlike_ranks([program, [*program, "--no-surfels"]]), timeout=PATIENCE, capture_output=True, text=True)
        self.assertEqual(1, done.returncode)
        self.assertEqual(1, done.stderr.count("were not started alike"), done.stderr)
        self.assertEqual([], self.clouds())

    def run_unlike(self, *folders):
        """Each rank in a folder of its own."""
        self.small("seen.las", 400)
        program = [os.path.join(PROGRAMS, "scancast-ranks"), "ingest", "seen.las", "-q", "-o", self.path("x.scan")]
        return subprocess.run(by_unlike_ranks([program] * len(folders), folders), timeout=PATIENCE, capture_output=True, text=True)

    def test_whatever_ends_it_while_the_file_is_written_leaves_nothing(self):
        for how in ("rank 1 is killed", signal.SIGTERM, signal.SIGINT):
            with self.subTest(how=how):
                job = subprocess.Popen(by_ranks(2, os.path.join(TESTS, "ingest_by_ranks"), self.home.name, "--stop-while-writing", self.path("a.las")),
                                       stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
                self.assertEqual("writing\n", job.stdout.readline())
                self.assertGreater(os.path.getsize(self.path("stopped.scan.partial")), 4096)
                if how == signal.SIGINT:  # once is enough
                    refused = self.run_one("ingest", self.path("b.las"), "-q", "-o", self.path("stopped.scan"))
                    self.assertIn("another run is writing this file", refused.stderr)
                if how == "rank 1 is killed":
                    os.kill(self.rank_of(job.pid), signal.SIGKILL)
                else:
                    job.send_signal(how)
                self.assertNotEqual(0, job.wait(timeout=PATIENCE))
                job.stdout.close()
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
