#!/usr/bin/python3
"""What each pass of method pyramid costs, scan by scan.

    tests/bench/pyramid/passes.py [SCAN...] [--data ../shared/data] [--scancast build/release/bin/scancast]
                                   [--backend cpu] [--size 1248x768] [--repeat 9] [--least 5000] [-- FLAGS OF render]

Bouchiba, Deschaud and Goulette, "Raw point cloud deferred shading through screen space pyramidal operators", 2018, §4,
says that the screen passes do not depend on the scene and cost what its one geometry pass does (table 1). Draws the scans
that are named, or all beneath --data (but for folders called `bad`), as their looks say, at the paper's size and one
sample a pixel, and prints Markdown: medians in ms of the geometry pass - a pixel a point, and what makes planes of it -,
of hidden point removal, pull-push, normals and light, and the screen passes' share of all five. Reading a scan is not
counted. At the end the least, median and greatest of each column. Scans of less than --least points and those that
cannot be read are named, and skipped. Ends with 2 where nothing could be measured.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile

ENDINGS = (".las", ".laz", ".ply", ".pcd", ".e57", ".pts", ".ptx", ".xyz", ".txt", ".csv")
OCTREES = ("ept.json", "cloud.js", "metadata.json")  # of EPT and Potree: what lies beside and beneath is theirs
GEOMETRY = ("nearest", "resolve")
SCREEN = ("hidden points", "pull-push", "normals", "phong")
PATIENCE = 600  # seconds for one scan


def scans_beneath(folder):
    for place, folders, files in os.walk(folder):
        folders[:] = sorted(name for name in folders if name != "bad")
        octrees = [name for name in files if name in OCTREES]
        if octrees:
            folders.clear()
        for name in octrees or sorted(files):
            if octrees or name.lower().endswith(ENDINGS):
                yield os.path.join(place, name)


def measured(arguments, scan, picture):
    """Of a scan: points, samples drawn, ms by column; or why not."""
    width, height = arguments.size.split("x")
    command = [arguments.scancast, "render", scan, "-o", picture, "--method", "pyramid", "--samples", "1", "--shading", "phong",
               "--width", width, "--height", height, "--backend", arguments.backend, "--repeat", str(arguments.repeat),
               "--stats", "json", *arguments.flags]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False)
    if done.returncode != 0:
        raise RuntimeError((done.stderr.strip().splitlines() or ["it ended with " + str(done.returncode)])[-1])
    stats = json.loads(done.stdout)
    stages = {stage["name"]: stage["medianMs"] for stage in stats["stages"]}
    row = [sum(stages.get(name, 0) for name in GEOMETRY)] + [stages.get(name, 0) for name in SCREEN]
    return stats["points"], stats["samples"], row


def line(name, points, samples, row):
    share = 100 * sum(row[1:]) / sum(row) if sum(row) > 0 else 0
    return f"| {name} | {points} | {samples} | " + " | ".join(f"{ms:.1f}" for ms in row) + f" | {share:.0f} % |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scans", nargs="*")
    parser.add_argument("--data", default="../shared/data")
    parser.add_argument("--scancast", default="build/release/bin/scancast")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--size", default="1248x768")
    parser.add_argument("--repeat", type=int, default=9)
    parser.add_argument("--least", type=int, default=5000)
    own, flags = sys.argv[1:], []
    if "--" in own:
        own, flags = own[:own.index("--")], own[own.index("--") + 1:]
    arguments = parser.parse_args(own)
    arguments.flags = flags
    scans = arguments.scans or list(scans_beneath(arguments.data))
    print("| scan | points | drawn | geometry | hidden points | pull-push | normals | phong | screen |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for scan in scans:
            name = os.path.relpath(scan, arguments.data) if not arguments.scans else scan
            try:
                points, samples, row = measured(arguments, scan, os.path.join(folder, "picture.png"))
            except (RuntimeError, subprocess.TimeoutExpired, ValueError, KeyError) as problem:
                print(f"skipped: {name}: {problem}", file=sys.stderr)
                continue
            if points < arguments.least:
                print(f"skipped: {name}: {points} points", file=sys.stderr)
                continue
            rows.append(row)
            print(line(name, points, samples, row), flush=True)
    if not rows:
        print("passes.py: nothing could be measured; name scans, or a folder of them with --data", file=sys.stderr)
        return 2
    columns = list(zip(*rows))
    for what, of in (("least", min), ("median", statistics.median), ("greatest", max)):
        print(line(f"**{what}**", "", "", [of(column) for column in columns]).rsplit("|", 2)[0] + "| |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
