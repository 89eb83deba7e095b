#!/usr/bin/env python3
"""How long a scan keeps people waiting: seconds from the start of `scancast serve` to the first picture of it.

    tests/bench/first_picture.py [--scancast PROGRAM] [--json FILE] FILES...

Asks for a small picture again and again. Prints when the first one came and of how many points it was, and when the whole scan was there:
a scan that is still being read is shown coarsely.

    tests/bench/first_picture.py ../shared/data/laz/autzen-stadium-10m.laz
"""
import argparse
import json
import os
import re
import subprocess
import sys
import time
import urllib.error
import urllib.request

from figures import told

LONGEST = 600  # seconds


def answer(url):
    """Bytes, or None where the server has none yet."""
    try:
        with urllib.request.urlopen(url) as response:
            return response.read()
    except urllib.error.HTTPError as problem:
        if problem.code not in (404, 503):
            raise
        return None


def wait_for(scancast, scan):
    """(seconds to the first picture, its points, seconds to the whole, its points)"""
    start = time.monotonic()
    server = subprocess.Popen([scancast, "serve", scan, "--port", "0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        line = server.stdout.readline()
        url = re.search(r"http://[^/\s]+", line)
        if not url:
            sys.exit(f"{scan}: the server says no address, but: {line.strip()!r}")
        cloud = None
        first = None
        while time.monotonic() - start < LONGEST:
            if cloud is None:
                entries = json.loads(answer(f"{url.group(0)}/api/v1/clouds"))["clouds"]
                cloud = f"{url.group(0)}/api/v1/clouds/{entries[0]['id']}" if entries else None
                continue
            entry = json.loads(answer(cloud))
            if entry["state"] == "failed":
                sys.exit(f"{scan}: {entry.get('error', 'it cannot be read')}")
            if first is None and answer(f"{cloud}/snapshot.jpg?width=960&height=540"):
                first = time.monotonic() - start, json.loads(answer(cloud))["points"]
            if entry["state"] == "ready" and first:
                return *first, time.monotonic() - start, entry["points"]
            time.sleep(0.02)
        sys.exit(f"{scan}: no picture within {LONGEST} s")
    finally:
        server.terminate()
        server.wait()


def main():
    root = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="FILES", nargs="+", help="scans, or cloud files")
    parser.add_argument("--scancast", metavar="PROGRAM", default=os.path.join(root, "build/release/bin/scancast"), help="by default %(default)s")
    told.add_option(parser)
    arguments, sheet = parser.parse_args(), told.Told()
    for scan in arguments.files:
        first, some, whole, points = wait_for(arguments.scancast, scan)
        print(f"{os.path.basename(scan)}: first picture after {first:.2f} s, of {some:,} points; whole after {whole:.2f} s, {points:,} points", flush=True)
        sheet.figure(os.path.basename(scan), first, "s", points=some, wholeSeconds=whole, wholePoints=points)
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
