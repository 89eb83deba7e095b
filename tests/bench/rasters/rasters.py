#!/usr/bin/env python3
"""How long rasters of a cloud file take: elevations of every kind, packed and not, and orthophotos, by the command line; and the memory that each took
at the most. Files are written into a temporary folder and forgotten.

    tests/bench/rasters/rasters.py CLOUD.scan [--program build/release/bin/scancast] [--cell 0.5] [--rounds 3] [--memory-limit 2G]
"""
import argparse
import os
import re
import resource
import subprocess
import tempfile
import time


def run(arguments):
    """Seconds, and the program's own words."""
    start = time.monotonic()
    done = subprocess.run(arguments, stderr=subprocess.PIPE, text=True)
    if done.returncode:
        raise SystemExit(done.stderr)
    return time.monotonic() - start, done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cloud")
    parser.add_argument("--program", default="build/release/bin/scancast")
    parser.add_argument("--cell", default="0.5")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--memory-limit", default="2G")
    given = parser.parse_args()
    kinds = [("dem", "--value", value) for value in ("highest", "lowest", "mean", "count")]
    kinds += [("dem", "--compress", "none"), ("dem", "--fill", "8"), ("ortho", "--backend", "cpu")]
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "out.tif")
        for kind in kinds:
            seconds = []
            for _ in range(given.rounds):
                took, said = run([given.program, kind[0], given.cloud, "--cell", given.cell, "--memory-limit", given.memory_limit, "-f", "-o", out,
                                  *kind[1:]])
                seconds.append(took)
            cells = re.search(r"(\d+) x (\d+) cells", said)
            print(f"{' '.join(kind):24} {cells.group(0):22} {sorted(seconds)[len(seconds) // 2]:7.2f} s   {os.path.getsize(out) / 1e6:8.1f} MB", flush=True)
    print(f"most memory of any: {resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
