#!/usr/bin/python3
"""Whether brightness jumps while the camera comes near: what a change of method or level on the way would show as.

    tests/bench/dolly.py [--scancast PROGRAM] [--steps N] [--nearest SHARE] [--width N] [--height N] SCANS... [-- FLAGS]

The camera of the scan's first view (`scancast look`) starts at twice its distance to what it sees in its middle and comes near by the
same factor with each of N steps (150), to SHARE (0.1) of the distance. Prints, for each scan: the methods that were drawn; mean luminance
(0 to 1) of the covered pixels first and last; and the greatest change from one picture to the next, in percent, and where. FLAGS go
to every `scancast render`. Ends with 1 if a change is greater than 2 %.

    tests/bench/dolly.py --scancast build/release/bin/scancast ../shared/data/ply/bunny-tristrips.ply
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile

import png_file
from sight.camera import camera_flags
from sight.measure import BLUE, GREEN, RED, luminances

MOST = 0.02
WHITE = RED[255] + GREEN[255] + BLUE[255]


def said(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, check=False)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr.decode(errors='replace')}")
    return done.stdout


def mean_luminance(picture):
    alpha = picture.channel(3)
    covered = sum(alpha)
    return sum(l * a for l, a in zip(luminances(picture), alpha)) / covered / WHITE if covered else None


def seen_in_the_middle(draw, camera):
    """The camera with its target where it sees something, as near to the picture's middle as there is something: else the dolly
    would end within the thing."""
    away = sum((t - e) ** 2 for e, t in zip(camera["eye"], camera["target"])) ** 0.5
    picture = draw(camera, 1, "--color", "depth", "--colormap", "grey", "--range", f"0,{2 * away!r}", "--method", "paraboloid", "--shading", "unlit")[0]
    middle = (picture.width // 2, picture.height // 2)
    covered = [i for i, alpha in enumerate(picture.channel(3)) if alpha == 255]
    nearest = min(covered, key=lambda i: (i % picture.width - middle[0]) ** 2 + (i // picture.width - middle[1]) ** 2)
    share = 2 * picture.channel(0)[nearest] / 255
    return {**camera, "target": [e + (t - e) * share for e, t in zip(camera["eye"], camera["target"])]}


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("scans", nargs="+", metavar="SCANS")
    options.add_argument("--scancast", default=os.path.join(here, "../../build/release/bin/scancast"))
    options.add_argument("--steps", type=int, default=150)
    options.add_argument("--nearest", type=float, default=0.1)
    options.add_argument("--width", type=int, default=480)
    options.add_argument("--height", type=int, default=270)
    given, flags = sys.argv[1:], []
    if "--" in given:
        given, flags = given[:given.index("--")], given[given.index("--") + 1:]
    options = options.parse_args(given)
    worst = 0
    with tempfile.TemporaryDirectory() as folder:
        picture = os.path.join(folder, "x.png")
        for scan in options.scans:
            cloud = scan
            if not scan.endswith(".scan"):  # opened once for each picture
                cloud = os.path.join(folder, "cloud.scan")
                said(options.scancast, "ingest", scan, "-o", cloud, "--force")

            def draw(camera, factor, *more):
                stats = said(options.scancast, "render", cloud, "-o", picture, "--background", "transparent", "--stats", "json",
                             f"--width={options.width}", f"--height={options.height}", *camera_flags(camera, factor), *(more or flags))
                return png_file.read(picture), json.loads(stats)["method"]

            camera = seen_in_the_middle(draw, json.loads(said(options.scancast, "look", cloud))["views"][0]["camera"])
            means, methods = [], []
            for step in range(options.steps + 1):
                drawn, method = draw(camera, 2 * (options.nearest / 2) ** (step / options.steps))
                means.append(mean_luminance(drawn))
                methods.append(method)
            changes = [abs(b / a - 1) for a, b in zip(means, means[1:]) if a and b]
            greatest = max(changes, default=0)
            worst = max(worst, greatest)
            print(f"{os.path.basename(scan):<32} {', '.join(dict.fromkeys(methods)):<20} {means[0] or 0:.3f} to {means[-1] or 0:.3f}, "
                  f"changes by {100 * greatest:.2f} % at most, in step {changes.index(greatest) + 1 if changes else 0}", flush=True)
    return worst > MOST


if __name__ == "__main__":
    sys.exit(main())
