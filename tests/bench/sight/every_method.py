#!/usr/bin/python3
"""Contact sheets of scans in every method: as they are seen first, and from nearer.

    tests/bench/sight/every_method.py [--scancast PROGRAM] [--out FOLDER] [--near 0.3] [--jobs N] FILES... [-- FLAGS]

Of each file two sheets, NAME-first.png and NAME-near.png, eleven pictures each, lit as each method is lit unless FLAGS say
otherwise. --near: how far from its target the eye of the second sheet stands, in distances of the first. FLAGS go to every
`scancast render`. Under each picture stand the milliseconds that it took, with all of its samples and whatever else the machine does.

    tests/bench/sight/every_method.py --out sheets lion.laz kitten.xyz -- --color '#c8b890'
"""
import argparse
import json
import multiprocessing
import os
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import png_file  # noqa: E402
from methods import METHODS, first_camera, output_of  # noqa: E402
from sight import sheet  # noqa: E402
from sight.camera import camera_flags  # noqa: E402

WIDE, HIGH = 2 * sheet.WIDE, 2 * sheet.HIGH


def drawn(job):
    program, cloud, method, flags, file = job
    stats = json.loads(output_of([program, "render", cloud, "-o", file, "--width", str(WIDE), "--height", str(HIGH), "--method", method,
                                  "--stats", "json", *flags]))
    return sheet.Entry(method, "", f"{stats['medianMs']:.0f} ms", sheet.shrunk(png_file.read(file), WIDE, HIGH))


def sheets(arguments, flags, scan, folder, pool):
    name = os.path.basename(scan).split(".")[0]
    cloud = scan
    if not scan.endswith(".scan"):
        cloud = os.path.join(folder, "cloud.scan")
        output_of([arguments.scancast, "ingest", scan, "-o", cloud, "--force", "--quiet"])
    camera = first_camera(arguments.scancast, cloud)
    for title, near in (("first", 1), ("near", arguments.near)):
        seen = camera_flags(camera, near) + ([] if "--shading" in flags else ["--shading", "auto"]) + flags
        jobs = [(arguments.scancast, cloud, method, seen, os.path.join(folder, f"{method}.png")) for method in METHODS]
        file = os.path.join(arguments.out, f"{name}-{title}.png")
        png_file.write(file, sheet.sheet(pool.map(drawn, jobs), WIDE, HIGH))
        print(file, flush=True)


def main():
    here, flags = sys.argv[1:], []
    if "--" in here:
        flags = here[here.index("--") + 1:]
        here = here[:here.index("--")]
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
    parser.add_argument("--scancast", default=os.path.join(root, "build/release/bin/scancast"), help="the program")
    parser.add_argument("--out", default=".", help="where the sheets go")
    parser.add_argument("--near", type=float, default=0.3, help="distance of the second sheet, of the first's")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="pictures at once")
    parser.add_argument("files", nargs="+")
    arguments = parser.parse_args(here)
    os.makedirs(arguments.out, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, multiprocessing.Pool(arguments.jobs) as pool:
        for scan in arguments.files:
            sheets(arguments, flags, scan, folder, pool)


if __name__ == "__main__":
    main()
