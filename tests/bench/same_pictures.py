#!/usr/bin/python3
"""Whether two builds draw the same pictures and write the same cloud files, byte for byte.

    tests/bench/same_pictures.py BEFORE AFTER [--clouds town,room,SCAN...] [--data ../shared/data]
                                 [--backend cpu,egl] [--every N] [--points 2M] [--keep DIR]

BEFORE and AFTER are two `scancast` programs. Each of them generates and ingests the clouds, whose files are compared,
and serves its own files; then both are asked for the same views:
  - every method that BEFORE lists, auto too, from far, home, near, inside, along the ground and from above
    (orthographic), with 1 and 4 samples a pixel; wider than a tile of the CPU device; as JPEG and as depth; every
    parameter of every method at another value than its own,
  - colour sources and maps, shadings, backgrounds, clip boxes, classes, detail, budget, near and far planes,
  - before mirrors, where a cloud has some, with and without what they show and what lies behind them,
  - by `render`: brute force, within little memory, straight from the scan.
By default on the CPU device, of the generated town and room, an airborne scan (LAS) and a statue (PLY): 1600 views, two
minutes on two cores. Scans that are not there are skipped, loudly. On GL devices every 8th view is drawn, some of each
method (--every changes that).

Prints per cloud, backend and method how many views there were, how many pictures differ from each other (a camera
that misses the cloud would show here), and how many are alike; names those that are not. Ends with 1 when a byte
differs, with 2 when nothing could be compared. --keep writes both pictures of differing views to a folder.
"""
import argparse
import concurrent.futures
import hashlib
import http.client
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time
import urllib.parse

SCANS = {"airborne": "las/autzen_trim.las", "statue": "ply/guanyin-statue.ply"}
ROOM_POINTS = "500k"
SMALL = {"width": "480", "height": "320"}
PATIENCE = 120  # seconds for one answer
LITTLE_MEMORY = "64M"


class Build:
    """One of the two programs, with the files it wrote and the server it runs."""

    def __init__(self, name, program, folder):
        self.name, self.program, self.folder = name, os.path.abspath(program), os.path.join(folder, name)
        self.server, self.connection = None, None
        os.mkdir(self.folder)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def run(self, *arguments):
        done = subprocess.run([self.program, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
        if done.returncode != 0:
            raise SystemExit(f"{self.name}: {self.program} {' '.join(arguments)} ended with {done.returncode}: "
                             f"{done.stderr.decode(errors='replace').strip()}")

    def serve(self, cloud_file, backend):
        self.server = subprocess.Popen([self.program, "serve", cloud_file, "--port", "0", "--backend", backend, "--log-level", "error"],
                                       stdout=subprocess.PIPE, text=True)
        address = re.search(r"http://([^/]+)", self.server.stdout.readline())
        if not address:
            raise SystemExit(f"{self.name}: {self.program} serve does not say where it listens")
        self.connection = http.client.HTTPConnection(address.group(1), timeout=PATIENCE)
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            clouds = json.loads(self.get("/api/v1/clouds")[1])["clouds"]
            if clouds and clouds[0]["state"] == "ready" and self.draws(clouds[0]["id"]):
                return clouds[0]
            time.sleep(0.02)
        raise SystemExit(f"{self.name}: {cloud_file} is not drawn after {PATIENCE} s")

    def draws(self, cloud_id):
        """Whether the device is open, too."""
        return self.get(f"/api/v1/clouds/{cloud_id}/snapshot.png?width=8&height=8")[0] == 200

    def stop(self):
        if self.connection:
            self.connection.close()
        if self.server:
            self.server.terminate()
            self.server.wait(PATIENCE)
            self.server.stdout.close()
        self.server, self.connection = None, None

    def get(self, path):
        self.connection.request("GET", path)
        answer = self.connection.getresponse()
        return answer.status, answer.read()

    def draw(self, view, cloud_id):
        """Status and bytes of a view; a server that does not answer is a status of 0."""
        try:
            if view["kind"] == "render":
                return self.render(view)
            if view["kind"] == "depth":
                body = json.dumps({"method": view["words"]["method"], "width": 480, "height": 320})
                self.connection.request("POST", f"/api/v1/clouds/{cloud_id}/snapshot", body,
                                        {"Content-Type": "application/json", "Accept": "application/octet-stream"})
                answer = self.connection.getresponse()
                return answer.status, answer.read()
            return self.get(f"/api/v1/clouds/{cloud_id}/snapshot.{view['kind']}?{urllib.parse.urlencode(view['words'])}")
        except (OSError, http.client.HTTPException) as problem:
            self.connection.close()
            return 0, str(problem).encode()

    def render(self, view):
        picture = self.path("render.png")
        size = [word for name, value in SMALL.items() for word in (f"--{name}", value)]
        done = subprocess.run([self.program, "render", self.path(view["file"]), "-o", picture, *size, *view["flags"]],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        if done.returncode != 0:
            return 0, done.stderr
        with open(picture, "rb") as file:
            return 200, file.read()


def vector(values):
    return ",".join(f"{value:.9g}" for value in values)


def cameras(cloud):
    """Name and words of cameras that any cloud has, from its bounds."""
    low, high = cloud["bounds"]["min"], cloud["bounds"]["max"]
    size = [b - a for a, b in zip(low, high)]
    diagonal = math.hypot(*size)
    at = lambda x, y, z: vector([a + f * s for a, s, f in zip(low, size, (x, y, z))])
    middle = at(0.5, 0.5, 0.4)
    away = vector([a + s / 2 + d * 3 * diagonal for a, s, d in zip(low, size, (0.6, -0.7, 0.4))])
    above = vector([low[0] + size[0] / 2, low[1] + size[1] / 2, high[2] + diagonal])
    return {
        "home": {},
        "far": {"eye": away, "target": middle, "up": "0,0,1"},
        "near": {"eye": at(0.62, 0.38, 0.75), "target": at(0.5, 0.5, 0.3), "up": "0,0,1"},
        "inside": {"eye": at(0.5, 0.5, 0.5), "target": at(1, 0.8, 0.4), "up": "0,0,1", "fov": "80"},
        "grazing": {"eye": at(0.02, 0.1, 0.12), "target": at(0.9, 0.8, 0.1), "up": "0,0,1", "fov": "40"},
        "above": {"eye": above, "target": middle, "up": "0,1,0", "projection": "orthographic", "viewHeight": f"{0.6 * size[1]:.9g}"},
    }


def mirror_cameras(cloud):
    for number, mirror in enumerate(cloud["mirrors"]):
        center, normal, up = mirror["center"], mirror["normal"], mirror["up"]
        side = [normal[1] * up[2] - normal[2] * up[1], normal[2] * up[0] - normal[0] * up[2], normal[0] * up[1] - normal[1] * up[0]]
        for name, distance, aside in (("before", 1.6, 0.2), ("oblique", 1.0, 1.2)):
            eye = [c + distance * mirror["width"] * n + aside * s for c, n, s in zip(center, normal, side)]
            yield f"{name} mirror {number}", {"eye": vector(eye), "target": vector(center), "up": vector(up)}


def styles(cloud):
    low, high = cloud["bounds"]["min"], cloud["bounds"]["max"]
    named = {attribute["name"] for attribute in cloud["attributes"]}
    sources = [name for name in ("rgb", "intensity", "classification", "normal", "curvature") if name in named]
    yield from ({"color": source} for source in [*sources, "elevation", "depth", "lod", "#d08030"])
    yield from ({"color": "elevation", "colormap": name} for name in ("turbo", "grey"))
    yield {"color": "elevation", "range": f"{low[2]:.9g},{(low[2] + high[2]) / 2:.9g}"}
    yield from ({"shading": name} for name in ("unlit", "eyedome", "phong"))
    yield {"shading": "eyedome", "color": "intensity" if "intensity" in named else "depth", "background": "transparent"}
    yield from ({"background": name} for name in ("transparent", "#ffffff", "#203040,#a08060"))
    inner = [a + (b - a) * f for f in (0.2, 0.7) for a, b in zip(low, high)]
    yield {"clip": vector(inner)}
    yield {"clip": vector(inner), "shading": "eyedome", "background": "transparent"}
    if cloud.get("classes"):
        yield {"classes": ",".join(str(number) for number in cloud["classes"][:2])}
        yield {"classes": "none"}
    yield from ({"detail": size} for size in ("0.5", "4", "30"))
    yield from ({"budget": count} for count in ("1000", "50000"))
    yield {"detail": "8", "samples": "4"}
    diagonal = math.dist(low, high)
    yield {"near": f"{0.3 * diagonal:.9g}", "far": f"{1.1 * diagonal:.9g}"}


def other_values(parameter):
    """Values of a method's parameter that are not its default."""
    if parameter["type"] == "choice":
        return [choice for choice in parameter["choices"] if choice != parameter["default"]]
    if parameter["type"] == "boolean":
        return ["false" if parameter["default"] else "true"]
    default = parameter["default"]
    if default == 0:
        return [f"{min(3.0, parameter['max'] / 2):.9g}"]
    return [f"{value:.9g}" for value in (default / 2, default * 2) if parameter["min"] <= value <= parameter["max"]][:2]


def views_of(cloud, methods, scan):
    """All views of a cloud, each with a name, in the order of methods."""
    found = []

    def add(method, name, words, kind="png", **more):
        found.append({"method": method, "name": name, "kind": kind, "words": {**SMALL, "method": method, **words}, **more})

    every_camera, every_style = cameras(cloud), list(styles(cloud))
    for number, (method, parameters) in enumerate(methods.items()):
        for name, camera in every_camera.items():
            for samples in ("1", "4"):
                add(method, f"{name}, samples {samples}", {**camera, "samples": samples})
        add(method, "wide", {**every_camera["grazing"], "width": "2600", "height": "300", "samples": "1"})
        add(method, "high", {**every_camera["near"], "width": "300", "height": "2300", "samples": "1"})
        add(method, "jpeg", {"quality": "80", "subsampling": "4:4:4"}, "jpg")
        add(method, "depth", {}, "depth")
        add(method, "eyedome, transparent", {**every_camera["near"], "shading": "eyedome", "background": "transparent"})
        for parameter in parameters:
            for value in other_values(parameter):
                add(method, f"{parameter['name']}={value}", {**every_camera["near"], f"param.{parameter['name']}": value, "samples": "1"})
        # Each style with a few methods, each method with some styles.
        for at, style in enumerate(every_style):
            if at % 4 == number % 4:
                told = " ".join(f"{word}={value}" for word, value in style.items())
                add(method, told, {**every_camera["home" if at % 2 else "near"], "samples": "1", **style})
        for name, camera in mirror_cameras(cloud):
            for shown, behind in (("true", "false"), ("false", "false"), ("true", "true")):
                add(method, f"{name}, mirrors={shown}, behindMirrors={behind}",
                    {**camera, "samples": "1", "mirrors": shown, "behindMirrors": behind})
            add(method, f"{name}, samples 4", {**camera, "samples": "4"})
        add(method, "render --brute-force", {}, "render", file="cloud.scan", flags=["--method", method, "--brute-force", "--samples", "1"])
    tight = ["--memory-limit", LITTLE_MEMORY, "--detail", "0.5"]
    add("paraboloid", "render, little memory", {}, "render", file="cloud.scan", flags=[*tight, "--method", "paraboloid"])
    add("paraboloid", "render, from the scan", {}, "render", file=scan, flags=["--method", "paraboloid"])
    add("disc", "render, from the scan", {}, "render", file=scan, flags=["--method", "disc"])
    return found


def digest_of(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read()).hexdigest()


class Comparison:
    """Counts, and what differs."""

    def __init__(self, builds, pool, keep):
        self.builds, self.pool, self.keep = builds, pool, keep
        self.same, self.differing = 0, []

    def both(self, work):
        return list(self.pool.map(work, self.builds))

    def note(self, name, same):
        self.same += same
        if not same:
            self.differing.append(name)

    def file(self, cloud, name):
        digests = [digest_of(build.path(name)) for build in self.builds]
        same = digests[0] == digests[1]
        self.note(f"{cloud}: {name}, {digests[0][:12]} and {digests[1][:12]}", same)
        print(f"| {cloud} | file | {name} | 1 | 1 | {int(same)} | {int(not same)} |", flush=True)

    def view(self, where, view, ids):
        """Digest of the first build's picture."""
        answers = list(self.pool.map(lambda pair: pair[0].draw(view, pair[1]), zip(self.builds, ids)))
        name = f"{where}: {view['method']}, {view['name']}"
        if answers[0][0] != 200:
            raise SystemExit(f"{name}: BEFORE does not draw this view ({answers[0][0]}): {answers[0][1][:400].decode(errors='replace')}")
        same = answers[0] == answers[1]
        refusal = "" if answers[1][0] == 200 else f": AFTER does not draw it ({answers[1][1][:200].decode(errors='replace')})"
        self.note(name + refusal, same)
        if not same and self.keep:
            for build, (_, data) in zip(self.builds, answers):
                kind = "png" if view["kind"] == "render" else view["kind"]
                with open(os.path.join(self.keep, re.sub(r"[^\w.=,-]+", "_", f"{name}_{build.name}") + f".{kind}"), "wb") as file:
                    file.write(data)
        return same, hashlib.sha256(answers[0][1]).hexdigest()

    def pictures(self, cloud, backend, every, scan):
        try:
            described = self.both(lambda build: build.serve(build.path("cloud.scan"), backend))
            methods = {method["name"]: method["parameters"] for method in json.loads(self.builds[0].get("/api/v1/methods")[1])["methods"]}
            rows = {method: [0, 0, set()] for method in methods}
            views = views_of(described[0], methods, scan)
            for view in views[every - 1::every]:
                if view["kind"] == "render":
                    view["flags"] = [*view["flags"], "--backend", backend]
                same, digest = self.view(f"{cloud}, {backend}", view, [one["id"] for one in described])
                row = rows[view["method"]]
                row[0 if same else 1] += 1
                row[2].add(digest)
        finally:
            self.both(Build.stop)
        for method, (same, different, pictures) in rows.items():
            print(f"| {cloud} | {backend} | {method} | {same + different} | {len(pictures)} | {same} | {different} |", flush=True)


def prepare(comparison, cloud, points, data):
    """Writes scan and cloud file with both builds; returns the scan's name, nothing where the scan is not there."""
    generated = {"town": ("town.las", points), "room": ("room.ply", ROOM_POINTS)}
    if cloud in generated:
        scan, count = generated[cloud]
        comparison.both(lambda build: build.run("generate", cloud, "--points", count, "-o", build.path(scan), "--quiet"))
        comparison.file(cloud, scan)
    else:
        scan = os.path.abspath(os.path.join(data, SCANS[cloud]) if cloud in SCANS else cloud)
        if not os.path.exists(scan):
            print(f"same_pictures.py: SKIPPED {cloud}: there is no {scan}; --data names the folder", file=sys.stderr, flush=True)
            return None
    comparison.both(lambda build: build.run("ingest", build.path(scan), "-o", build.path("cloud.scan"), "--force", "--quiet"))
    comparison.file(cloud, "cloud.scan")
    return scan


def compare(comparison, arguments):
    compared = 0
    print("| cloud | backend | method | views | pictures | same | different |\n|---|---|---|---|---|---|---|", flush=True)
    for cloud in arguments.clouds.split(","):
        scan = prepare(comparison, cloud, arguments.points, arguments.data)
        if scan is None:
            continue
        compared += 1
        for backend in arguments.backend.split(","):
            every = arguments.every or (1 if backend == "cpu" else 8)
            comparison.pictures(cloud, backend, every, scan)
    return compared


def main():
    root = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", metavar="BEFORE", help="the scancast program that is right")
    parser.add_argument("after", metavar="AFTER", help="the one to compare with it")
    parser.add_argument("--clouds", default="town,room," + ",".join(SCANS), help="these, or paths of scans; by default %(default)s")
    parser.add_argument("--data", default=os.path.join(root, "../shared/data"), help="folder of the real scans")
    parser.add_argument("--backend", default="cpu", help="cpu, egl, osmesa, comma between them; by default %(default)s")
    parser.add_argument("--every", type=int, help="draw every Nth view only")
    parser.add_argument("--points", default="2M", help="of the town")
    parser.add_argument("--keep", metavar="DIR", help="write pictures that differ to this folder")
    parser.add_argument("--folder", help="where to work; by default a temporary folder")
    arguments = parser.parse_args()
    if arguments.keep:
        os.makedirs(arguments.keep, exist_ok=True)
    start = time.monotonic()
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder, concurrent.futures.ThreadPoolExecutor(2) as pool:
        builds = [Build("before", arguments.before, folder), Build("after", arguments.after, folder)]
        comparison = Comparison(builds, pool, arguments.keep)
        compared = compare(comparison, arguments)
    for name in comparison.differing:
        print(f"DIFFERENT: {name}")
    print(f"{comparison.same} the same, {len(comparison.differing)} different, {compared} clouds, {time.monotonic() - start:.0f} s")
    sys.exit(1 if comparison.differing else 0 if compared else 2)


if __name__ == "__main__":
    main()
