"""`scancast-client view` with a mouse, a keyboard and a screen, under Xvfb: a window opens, shows the picture, and what
hands do reaches the server. Waits for what the program says (--trace); nothing is timed.

    view_window_test.py FOLDER_OF_THE_PROGRAMS
"""
import os
import queue
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

PROGRAMS = os.path.abspath(sys.argv.pop())
PATIENCE = 120  # seconds; only a hang takes so long


class Screen:
    """A virtual X display whose pixels are a file."""

    def __init__(self, folder):
        read, write = os.pipe()
        self.process = subprocess.Popen(["Xvfb", "-displayfd", str(write), "-screen", "0", "800x600x24", "-nolisten", "tcp",
                                         "-fbdir", folder], pass_fds=[write], stderr=subprocess.DEVNULL)
        os.close(write)
        with os.fdopen(read) as number:
            self.display = ":" + number.readline().strip()
        self.file = os.path.join(folder, "Xvfb_screen0")
        self.wait()

    def wait(self):
        """Until it answers: on a busy machine it says its number before it does."""
        end = time.monotonic() + PATIENCE
        while subprocess.run(["xdotool", "getdisplaygeometry"], env={**os.environ, "DISPLAY": self.display},
                             stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL).returncode != 0:
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"Xvfb does not answer on {self.display!r}")
            time.sleep(0.05)

    def colours(self):
        """How many different pixels there are (XWD: a header that tells its length, a table of colours, rows)."""
        with open(self.file, "rb") as file:
            data = file.read()
        header = struct.unpack(">25I", data[:100])
        pixels = data[header[0] + 12 * header[19]:][:header[12] * header[5]]
        return len({pixels[i:i + 4] for i in range(0, len(pixels), 4)})

    def stop(self):
        self.process.terminate()
        self.process.wait(30)


class Viewer:
    def __init__(self, screen, url, *flags):
        self.environment = {**os.environ, "DISPLAY": screen.display, "SDL_VIDEODRIVER": "x11", "SDL_RENDER_DRIVER": "software"}
        self.process = subprocess.Popen([os.path.join(PROGRAMS, "scancast-client"), "view", url, "--trace", *flags],
                                        env=self.environment, stdout=subprocess.PIPE, text=True)
        self.lines = queue.Queue()
        threading.Thread(target=self.read, daemon=True).start()

    def read(self):
        for line in self.process.stdout:
            self.lines.put(line.split())
        self.lines.put(None)

    def until(self, wanted):
        """The words of the first line from here on of which this holds."""
        while (line := self.lines.get(timeout=PATIENCE)) is not None:
            if wanted(line):
                return line
        raise AssertionError("the window has closed")

    def final(self, seq):
        return self.until(lambda line: line[:3] == ["frame", seq, "final"])

    def view(self):
        return self.until(lambda line: line[0] == "view")

    def hands(self, *commands):
        subprocess.run(["xdotool", *" ".join(commands).split()], env=self.environment, check=True, timeout=PATIENCE)

    def stop(self):
        if self.process.poll() is None:
            self.process.kill()
        self.process.wait(30)
        self.process.stdout.close()


class ViewWindow(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        scan = os.path.join(cls.folder.name, "ball.las")
        scancast = os.path.join(PROGRAMS, "scancast")
        subprocess.run([scancast, "generate", "sphere", "--points", "20000", "-o", scan, "--quiet"], check=True)
        with open(os.path.join(cls.folder.name, "log"), "w") as log:
            cls.server = serving.Server(scancast, scan, 8, log)
        cls.addClassCleanup(cls.server.stop)
        cls.screen = Screen(cls.folder.name)
        cls.addClassCleanup(cls.screen.stop)

    def viewer(self, *flags):
        viewer = Viewer(self.screen, self.server.url, *flags)
        self.addCleanup(viewer.stop)
        return viewer

    def test_hands_reach_the_server_and_pictures_the_screen(self):
        viewer = self.viewer("--width", "400", "--height", "300")
        first = viewer.view()
        self.assertEqual(viewer.final(first[1])[3], "400x300")
        self.assertGreater(self.screen.colours(), 100)

        viewer.hands("search --sync --name Scancast windowfocus")
        viewer.hands("mousemove 400 300 mousedown 1 mousemove_relative 60 0 mouseup 1")
        turned = viewer.view()
        self.assertNotEqual(turned[3:6], first[3:6], "a drag turns")
        viewer.hands("click 4")
        nearer = viewer.until(lambda line: line[0] == "view" and line[3:6] != turned[3:6])
        self.assertLess(sum(float(x) ** 2 for x in nearer[3:6]), sum(float(x) ** 2 for x in turned[3:6]))
        viewer.hands("key m")
        other = viewer.until(lambda line: line[0] == "view" and line[6] != first[6])
        viewer.hands("key 3")
        self.assertEqual(viewer.until(lambda line: line[0] == "quality"), ["quality", "fast"])
        viewer.hands("keydown w")
        flown = viewer.until(lambda line: line[0] == "view" and line[3:6] != other[3:6])
        viewer.hands("keyup w")
        self.assertEqual(flown[6], other[6])
        viewer.hands("search --name Scancast windowsize 320 240")
        resized = viewer.until(lambda line: line[0] == "view" and line[7] == "320x240")
        self.assertEqual(viewer.until(lambda line: line[0] == "frame" and line[2] == "final" and
                                      int(line[1]) >= int(resized[1]))[3], "320x240")
        viewer.hands("key Escape")
        self.assertEqual(viewer.process.wait(PATIENCE), 0)

    def test_closes_by_itself_when_told_so(self):
        viewer = self.viewer("--finals", "1")
        self.assertEqual(viewer.process.wait(PATIENCE), 0)

    def test_without_a_display_there_is_an_error(self):
        environment = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "WAYLAND_DISPLAY")}
        # With and without a word of the user's; without, SDL would draw where nobody looks, and never end.
        for driver in ({}, {"SDL_VIDEODRIVER": "x11"}):
            self.without_a_display(environment, driver)

    def without_a_display(self, environment, driver):
        done = subprocess.run([os.path.join(PROGRAMS, "scancast-client"), "view", self.server.url], capture_output=True, text=True,
                              env={**environment, **driver}, timeout=PATIENCE)
        self.assertEqual(done.returncode, 1)
        self.assertIn("no window can be opened here", done.stderr)
        self.assertIn("scancast-client snapshot", done.stderr)


if __name__ == "__main__":
    unittest.main()
