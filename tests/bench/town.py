#!/usr/bin/python3
"""The town of 20 million points: how soon it is seen, how fast it turns, whether it has holes, whether bytes agree.

    tests/bench/town.py [--bin build/release/bin] [--points 20M] [--file town.las] [--json FILE]

Generates the town (or takes --file), then prints
  - seconds from the start of `scancast serve` to the first picture, which is a coarse one, and to the whole scan,
  - frames/s of an orbit at 1280 x 720 with paraboloids: rendered at tau = 1, and through the live stream,
  - pixels without ground, looking down on streets from several heights at tau = 1,
  - whether one view is the same JPEG with 1 and 2 threads, each SIMD level, from render and from serve.
Needs Debian's python3-numpy (deploy/packages/bench.txt).
"""
import argparse
import hashlib
import json
import os
import re
import struct
import subprocess
import tempfile
import time
import zlib

from figures import told
from first_picture import LONGEST, answer

VIEW = ["--width", "1280", "--height", "720", "--method", "paraboloid", "--detail", "1"]


def run(*command, **more):
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, **more).stdout


def orbit(scancast, cloud, sheet):
    stats = json.loads(run(scancast, "render", cloud, *VIEW, "--samples", "1", "--repeat", "72", "--orbit", "15", "--stats", "json"))  # three turns
    stages = ", ".join(f"{stage['name']} {stage['medianMs']:.2f}" for stage in stats["stages"])
    print(f"orbit, tau = 1, view to JPEG: median {stats['medianMs']:.1f} ms = {1000 / stats['medianMs']:.1f} frames/s "
          f"({stats['samples']} samples in the last cut; {stages} ms)")
    sheet.figure("orbit rendered at τ = 1, paraboloids, view to JPEG", stats["medianMs"], "ms")


def transparent_pixels(png):
    """Pixels without any point in an RGBA PNG as Scancast writes it (filters 0 and 2 only)."""
    import numpy
    width, height = struct.unpack(">II", png[16:24])
    data, at = b"", 8
    while at < len(png):
        length, kind = struct.unpack(">I4s", png[at:at + 8])
        if kind == b"IDAT":
            data += png[at + 8:at + 8 + length]
        at += 12 + length
    rows = numpy.frombuffer(zlib.decompress(data), dtype="u1").reshape(height, 1 + width * 4)
    above, holes = numpy.zeros(width * 4, dtype="u1"), 0
    for row in rows:
        assert row[0] in (0, 2), "a PNG filter that this reader does not know"
        above = row[1:] + above if row[0] == 2 else row[1:]
        holes += int((above[3::4] == 0).sum())
    return holes


def holes(scancast, cloud, center, ground, folder, sheet):
    png = os.path.join(folder, "ground.png")
    for height, behind in ((6, 3), (15, 6), (40, 10), (60, 1)):
        x, y = center
        # The town is about 200 m wide; from these heights and steep angles the picture holds nothing but town.
        eye, target = f"{x - behind},{y - behind - 20},{ground + height}", f"{x},{y - 20},{ground}"
        run(scancast, "render", cloud, *VIEW, "--samples", "1", "--background", "transparent", f"--eye={eye}", f"--target={target}", "-o", png)
        with open(png, "rb") as file:
            count = transparent_pixels(file.read())
        print(f"from {height} m above the street, tau = 1: {count} of {1280 * 720} pixels are holes")
        sheet.figure(f"holes, from {height} m above the street at τ = 1, of {1280 * 720:,} pixels", count)


def serve(scancast, client, las, folder, sheet):
    """Times what is seen first, which is a coarse cloud, and the whole; gives the whole one's picture and what is known of it."""
    start = time.monotonic()
    server = subprocess.Popen([scancast, "serve", las, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        url = re.search(r"http://[^/]+", server.stdout.readline()).group(0)
        cloud = f"{url}/api/v1/clouds/{os.path.splitext(os.path.basename(las))[0]}"
        picture = f"{cloud}/snapshot.jpg?width=1280&height=720&method=paraboloid&detail=1"
        shown = False
        while True:
            known, now = json.loads(answer(cloud) or '{"state": "loading"}'), time.monotonic() - start
            if known["state"] == "failed" or now > LONGEST:
                raise SystemExit(f"{las} is not there after {now:.0f} s: {known.get('error', known['state'])}")
            if not shown and answer(picture):
                shown, now = True, time.monotonic() - start
                print(f"first picture {now:.2f} s after serve starts")
                sheet.figure("first still after `serve` starts, of a LAS file", now, "s")
            if known["state"] == "ready" and shown:
                break
            time.sleep(0.02)
        print(f"the whole scan {now:.1f} s after serve starts")
        sheet.figure("the whole scan after `serve` starts", now, "s")
        jpeg = answer(picture)
        out = run(client, "orbit", url, "--frames", "72", "--moving", "--width", "1280", "--height", "720", "-o", os.path.join(folder, "orbit"))
        print("orbit through the stream, moving quality:", out.decode().strip().splitlines()[-1])
        if rate := re.search(r"([\d.]+) frames/s", out.decode()):
            sheet.figure("orbit through the live stream, moving quality", float(rate.group(1)), "frames/s")
        return jpeg, json.loads(answer(cloud))
    finally:
        server.terminate()
        server.wait(20)


def same_bytes(scancast, cloud, served, folder, sheet):
    digests = {"serve": hashlib.sha256(served).hexdigest()}
    jpeg = os.path.join(folder, "view.jpg")
    for threads in ("1", "2"):
        for level in ("v2", "v3", "v4"):
            environment = {**os.environ, "SCANCAST_SIMD": level}
            try:
                run(scancast, "render", cloud, *VIEW, "--threads", threads, "-o", jpeg, env=environment)
            except subprocess.CalledProcessError:
                print(f"this processor has no {level}")
                continue
            with open(jpeg, "rb") as file:
                digests[f"render {level}, {threads} threads"] = hashlib.sha256(file.read()).hexdigest()
    alike = len(set(digests.values())) == 1
    sheet.figure(f"the same JPEG from {', '.join(digests)}", alike)
    print(f"the same JPEG from {', '.join(digests)}: {'yes' if alike else 'NO: ' + str(digests)}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    parser.add_argument("--bin", default=os.path.join(root, "build/release/bin"), help="folder of the scancast programs")
    parser.add_argument("--points", default="20M")
    parser.add_argument("--file", help="a town that is there already")
    told.add_option(parser)
    arguments = parser.parse_args()
    sheet = told.Told()
    scancast, client = (os.path.join(arguments.bin, name) for name in ("scancast", "scancast-client"))
    with tempfile.TemporaryDirectory() as folder:
        las = arguments.file or os.path.join(folder, "town.las")
        if not arguments.file:
            start = time.monotonic()
            run(scancast, "generate", "town", "--points", arguments.points, "-o", las)
            print(f"generated in {time.monotonic() - start:.1f} s")
            sheet.figure(f"generating it, LAS, {os.path.getsize(las) / 1e6:.0f} MB", time.monotonic() - start, "s")
        served, info = serve(scancast, client, las, folder, sheet)
        bounds = info["bounds"]
        print(f"{info['points']} points, {info['bytesResident'] / info['points']:.1f} bytes a point in memory, {os.cpu_count()} cores")
        sheet.figure("bytes a point in memory", info["bytesResident"] / info["points"])
        cloud = os.path.join(folder, "town.scan")
        run(scancast, "ingest", las, "-o", cloud)
        orbit(scancast, cloud, sheet)
        center = [(bounds["min"][axis] + bounds["max"][axis]) / 2 for axis in range(2)]
        holes(scancast, cloud, center, bounds["min"][2], folder, sheet)
        same_bytes(scancast, cloud, served, folder, sheet)
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
