"""Pictures by ranks have the bytes of one process': in every method, of the device, of `render`, and of a server that streams.

    pictures_test.py FOLDER_OF_THE_PROGRAMS FOLDER_OF_THE_TEST_PROGRAMS
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "load"))
import serving

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from by_mpirun import by_ranks

TESTS = os.path.abspath(sys.argv.pop())
PROGRAMS = os.path.abspath(sys.argv.pop())
PATIENCE = 120  # seconds; only a hang takes so long
QUERY = "width=160&height=90&samples=4&method=ewa"
FLAGS = ["--width", "160", "--height", "90", "--samples", "4", "--method", "ewa"]


class RanksServer(serving.Server):
    """Rank 0 is the server; its process is a child of mpirun's."""

    def __init__(self, count, cloud, log):
        self.process = subprocess.Popen(by_ranks(count, os.path.join(PROGRAMS, "scancast-ranks"), "serve", cloud, "--port", "0",
                                                 "--threads", "1", "--memory-limit", "128M"),
                                        stdout=subprocess.PIPE, stderr=log, text=True)
        # Whatever waits for it comes to an end then, and fails.
        self.hang = threading.Timer(PATIENCE, self.end)
        self.hang.daemon = True
        self.hang.start()
        try:
            found = re.search(r"http://([^/:]+):(\d+)", self.process.stdout.readline())
            if not found:
                raise AssertionError("scancast-ranks serve said no address")
            self.address = found.group(1), int(found.group(2))
            self.url = "http://%s:%d" % self.address
            self.cloud = self.wait_until_loaded()
        except BaseException:
            self.end()
            self.process.stdout.close()
            raise

    def end(self):
        """mpirun ends its ranks, if it still can."""
        self.hang.cancel()
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(15)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()

    def stop(self):
        """As somebody does who ends rank 0's process: the others are let go, and mpirun ends well."""
        with open(f"/proc/{self.process.pid}/task/{self.process.pid}/children") as children:
            ranks = [int(pid) for pid in children.read().split()]
        for pid in ranks:
            with open(f"/proc/{pid}/environ", "rb") as environment:
                if b"OMPI_COMM_WORLD_RANK=0\0" in environment.read():
                    os.kill(pid, signal.SIGTERM)
        try:
            return self.process.wait(PATIENCE)
        finally:
            self.end()
            self.process.stdout.close()


class PicturesByRanks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.cloud = os.path.join(cls.folder.name, "room.scan")
        scan = os.path.join(cls.folder.name, "room.las")
        scancast = os.path.join(PROGRAMS, "scancast")
        quiet = {"check": True, "capture_output": True, "timeout": PATIENCE}
        subprocess.run([scancast, "generate", "room", "--points", "400k", "-o", scan], **quiet)
        subprocess.run([scancast, "ingest", scan, "-o", cls.cloud], **quiet)
        cls.picture = os.path.join(cls.folder.name, "alone.png")
        subprocess.run([scancast, "render", cls.cloud, "-o", cls.picture, "--backend", "cpu", *FLAGS], **quiet)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def alone(self):
        with open(self.picture, "rb") as file:
            return file.read()

    def test_every_method_on_one_to_four_ranks(self):
        for count in (1, 2, 3, 4):
            with self.subTest(ranks=count):
                done = subprocess.run(by_ranks(count, os.path.join(TESTS, "pictures_by_ranks"), self.cloud), timeout=PATIENCE,
                                      capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                self.assertRegex(done.stdout, rf"{count} ranks, \d\d pictures, 0 differ")

    def test_render(self):
        output = os.path.join(self.folder.name, "together.png")
        done = subprocess.run(by_ranks(3, os.path.join(PROGRAMS, "scancast-ranks"), "render", self.cloud, "-o", output,
                                       "--stats", "json", *FLAGS), timeout=PATIENCE, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(json.loads(done.stdout)["bytesSentPerFrame"], 0)
        with open(output, "rb") as file:
            self.assertEqual(file.read(), self.alone())

    def test_what_is_no_cloud_file_is_said_once(self):
        done = subprocess.run(by_ranks(2, os.path.join(PROGRAMS, "scancast-ranks"), "serve",
                                       os.path.join(self.folder.name, "room.las"), "--port", "0"),
                              timeout=PATIENCE, capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stderr.count("scancast ingest"), 1, done.stderr)

    def test_who_cannot_start_keeps_nobody_waiting(self):
        """Rank 1 alone: no such processor; no such file; another file of that name."""
        program = os.path.join(PROGRAMS, "scancast-ranks")
        here, there = os.path.join(self.folder.name, "here"), os.path.join(self.folder.name, "there")
        for folder in (here, there):
            os.makedirs(folder, exist_ok=True)
        shutil.copy(self.cloud, os.path.join(here, "one.scan"))
        shutil.copy(self.cloud, os.path.join(here, "two.scan"))
        with open(self.cloud, "rb") as whole, open(os.path.join(there, "two.scan"), "wb") as part:
            part.write(whole.read(5000))
        render = [program, "render", self.cloud, "--stats", "json"]
        served = lambda name: [program, "serve", name, "--port", "0"]
        no_simd = ["env", "SCANCAST_SIMD=abacus"]
        for what, command, before, where in (("render", render, no_simd, None), ("serve", served(self.cloud), no_simd, None),
                                             ("no file", served("one.scan"), [], there),
                                             ("another file", served("two.scan"), [], there)):
            with self.subTest(what):
                first = ["env", "-C", here] if where else []
                second = ["env", "-C", where] if where else before
                done = subprocess.run(by_ranks(1, *first, *command) + [":", "-n", "1", *second, *command], timeout=PATIENCE,
                                      capture_output=True, text=True)
                self.assertNotEqual(done.returncode, 0, done.stdout)
                self.assertRegex(done.stderr, "abacus" if before else "On rank 1")

    def test_a_server_shows_streams_and_picks(self):
        with open(os.path.join(self.folder.name, "log"), "w+") as log:
            server = RanksServer(2, self.cloud, log)
            try:
                status, headers, body = server.get(f"/api/v1/clouds/{server.cloud}/snapshot.png?{QUERY}")
                self.assertEqual(status, 200, body)
                self.assertEqual(body, self.alone())
                picked = server.get(f"/api/v1/clouds/{server.cloud}/pick", method="POST",
                                    body=json.dumps({"view": {"width": 160, "height": 90}, "x": 80, "y": 60}),
                                    headers={"Content-Type": "application/json"})
                self.assertEqual(picked[0], 200, picked)
                self.assertIsNotNone(json.loads(picked[2]), "there is something in the middle of a room")
                client = os.path.join(PROGRAMS, "scancast-client")
                bench = subprocess.run([client, "bench", server.url, "--moving", "1", "--warm-up", "0", "--seconds", "1", "--width",
                                        "160", "--height", "90"], capture_output=True, text=True,
                                       timeout=PATIENCE)
                self.assertEqual(bench.returncode, 0, bench.stderr)
            finally:
                code = server.stop()
            log.seek(0)
            self.assertEqual(code, 0, log.read())


if __name__ == "__main__":
    if not shutil.which("mpirun"):
        print("MISSING mpirun: Debian's openmpi-bin", file=sys.stderr)
        sys.exit(77)
    os.environ.setdefault("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    unittest.main()
