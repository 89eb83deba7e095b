"""What sections measure with: programs, clouds made once, the sizes that were asked for. And what they need, told where it is missing."""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

from . import gate, machine, words

HERE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
BUILD_BENCH = "cmake --preset release -B build/bench -DSCANCAST_BENCH=ON && cmake --build build/bench --target"
BYTES_A_POINT = 40  # of disk, at most at a time, while a large cloud is made: what waits, and the file
METHODS = ["point", "square", "circle", "paraboloid", "cone", "sphere", "hqs", "disc", "ewa", "voronoi", "pyramid"]


class Failed(Exception):
    """Something that is there does not work."""


def run(command, **more):
    """What it prints. Its last complaint where it fails."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, text=True, errors="replace", check=False, **more)
    except OSError as problem:
        raise Failed(f"{command[0]}: {problem.strerror}") from None
    if done.returncode:
        lines = [line for line in done.stderr.strip().splitlines() if line.strip()]
        raise Failed(f"{os.path.basename(command[0])} {' '.join(command[1:2])} ended with {done.returncode}: {lines[-1] if lines else 'it says nothing'}")
    return done.stdout


def camera(scancast, cloud):
    """Flags for the view that the cloud is first seen in."""
    if HERE not in sys.path:
        sys.path.insert(0, HERE)
    from sight.camera import camera_flags
    return camera_flags(json.loads(run([scancast, "look", cloud]))["views"][0]["camera"])


class Bench:
    """Sizes and places. `quick` takes tiny ones: it shows that everything runs, and its figures mean nothing."""

    def __init__(self, given, folder):
        self.given, self.folder, self.quick = given, folder, given.quick
        self.scancast, self.client = (os.path.join(given.bin, name) for name in ("scancast", "scancast-client"))
        self.build = os.path.normpath(os.path.join(given.bin, ".."))
        self.points = 50_000 if given.quick else words.count(given.points)
        self.up_to = 100_000 if given.quick else words.count(given.points_up_to)
        self.size = (160, 90) if given.quick else (1280, 720)
        self.views, self.turns = (2, 1) if given.quick else (12, 3)
        self.rounds = 1 if given.quick else 3
        self.clouds = {}

    def methods(self, *wanted):
        chosen = list(wanted or METHODS)
        return [name for name in ("point", "ewa") if name in chosen] if self.quick else chosen

    # ---- clouds

    def path(self, name):
        return os.path.join(self.folder, name)

    def town_las(self, points=None):
        name = self.path(f"town-{words.short(points or self.points)}.las")
        if not os.path.exists(name):
            run([self.scancast, "generate", "town", "--points", str(points or self.points), "-o", name + ".part.las", "--quiet"])
            os.rename(name + ".part.las", name)
        return name

    def town(self, points=None, surfels=True, piped=False):
        """A cloud file of the town; large ones go through a pipe, so that no scan lies on disk."""
        points = points or self.points
        name = self.path(f"town-{words.short(points)}{'' if surfels else '-plain'}.scan")
        if os.path.exists(name):
            return name
        flags = [] if surfels else ["--no-surfels"]
        if points <= self.points and not piped:
            run([self.scancast, "ingest", self.town_las(points), "-o", name, "--quiet", "--force", *flags])
        else:
            command = [self.scancast, "generate", "town", "--points", str(points), "--format", "las14", "-o", "-", "--quiet"]
            with subprocess.Popen(command, stdout=subprocess.PIPE) as source:
                done = subprocess.run([self.scancast, "ingest", "-", "-o", name, "--quiet", "--force", *flags], stdin=source.stdout, stderr=subprocess.PIPE,
                                      text=True, check=False)
                source.stdout.close()
            if done.returncode or source.returncode:
                raise Failed(f"a town of {points:,} points: {(done.stderr.strip().splitlines() or ['generate failed'])[-1]}")
        return name

    def data(self, name):
        return os.path.join(self.given.data, name)

    # ---- running

    def turn(self, cloud, method=None, size=None, views=None, flags=(), scancast=None, samples=1):
        """Statistics of three turns about the cloud, `views` in each. Medians are then of views whose blocks are in memory since the first turn: with
        one turn, or two, they would be of reading as much as of drawing."""
        width, height = size or self.size
        views = min(views or self.views, self.views)
        return json.loads(run([scancast or self.scancast, "render", cloud, *(["--method", method] if method else []), "--width", str(width),
                               "--height", str(height), "--samples", str(samples), "--repeat", str(views * self.turns), "--orbit", f"{360 / views:g}",
                               "--stats", "json", *flags]))

    def script(self, name, *arguments, told=True):
        """Rows that a benchmark of this folder tells (told.py)."""
        path = os.path.normpath(os.path.join(HERE, name))
        starter = [] if os.access(path, os.X_OK) else [sys.executable]
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            told_to = os.path.join(folder, "told.json")
            self.log(run([*starter, path, *map(str, arguments), *(["--json", told_to] if told else [])]))
            with open(told_to, encoding="utf-8") as file:
                return json.load(file)["figures"]

    def log(self, text):
        with open(self.path("all.log"), "a", encoding="utf-8") as file:
            file.write(text.rstrip() + "\n")

    def tool(self, name):
        """A program of the benchmarks, which is built on request."""
        for folder in (self.given.bench, os.path.join(self.build, "bench")):
            if os.path.exists(os.path.join(folder, name)):
                return os.path.join(folder, name)
        return os.path.join(self.given.bench, name)

    def able(self, command):
        """Of an old build: what it says where it cannot."""
        try:
            return run(command)
        except Failed as problem:
            raise gate.Unable(str(problem)) from None


def without(stats, *names):
    """Of render's statistics: the frame without these stages."""
    return stats["medianMs"] - sum(stage["medianMs"] for stage in stats["stages"] if stage["name"] in names)


def stage(stats, name):
    return sum(s["medianMs"] for s in stats["stages"] if s["name"] == name)


# ---- What a section needs: a function of a Bench that says what is missing and how to get it, or nothing.

def tools(*names):
    def missing(bench):
        lacking = [name for name in names if not os.path.exists(bench.tool(name))]
        return f"{' and '.join(lacking)} not built: `{BUILD_BENCH} {' '.join(lacking)}`" if lacking else None
    return missing


def program(name):
    def missing(bench):
        return None if os.path.exists(os.path.join(bench.given.bin, name)) else f"{name} is not in {bench.given.bin}: `./run.sh --build-only`"
    return missing


def scans(*names):
    def missing(bench):
        lacking = [name for name in names if not os.path.exists(bench.data(name))]
        return f"no {', '.join(lacking)} beneath the folder of real scans (`--data`)" if lacking else None
    return missing


def vtk(bench):
    done = subprocess.run(["/usr/bin/python3", "-c", "import vtk, numpy"], stderr=subprocess.DEVNULL, check=False)
    lacking = [*(["python3-vtk9, python3-numpy"] if done.returncode else []), *(["xvfb"] if not shutil.which("xvfb-run") else [])]
    return f"not installed: {', '.join(lacking)} (`deploy/packages/bench.txt`)" if lacking else None


def numpy(bench):
    done = subprocess.run(["/usr/bin/python3", "-c", "import numpy"], stderr=subprocess.DEVNULL, check=False)
    return "not installed: python3-numpy (`deploy/packages/bench.txt`)" if done.returncode else None


def opengl(bench):
    return None if "--backend=egl --egl-device" in machine.said(bench.scancast, "--list-backends") else \
        "no OpenGL by EGL, not even a software driver: install Debian's `libegl1 libgl1-mesa-dri`"


def graphics_card(bench):
    return None if machine.gpus(bench.scancast) or bench.given.gpu_results else \
        "no graphics card here. With one: `cmake --build --preset release --target bench_gpu_folder`, then this command; or `tests/bench/gpu_day.sh all` on " \
        "another machine, and `--gpu-results FOLDER` here"


def room(points):
    """Disk for so many points while they become a cloud file."""
    def missing(bench):
        free = shutil.disk_usage(bench.folder).free
        return None if free >= points * BYTES_A_POINT else \
            f"{words.short(points)} points need {points * BYTES_A_POINT / 1e9:.0f} GB of disk for a while; there are {free / 1e9:.0f} (`--folder` names another disk)"
    return missing
