#!/usr/bin/env python3
"""What columns cost (docs/decisions/032-columns-before-the-device.md): the size of a cloud file with them, and pictures of a view that filters and
colours by them against the same view without; the first picture after a step of a slider, and those that follow.

    tests/bench/columns/columns.py build/release/bin/scancast [--points 5M] [--memory-limit 2G] [--backend cpu]

Ingests a generated town (LAS 1.4, whose points have GPS times and returns) with and without its columns, serves the former and asks for snapshots of
1280 x 720 over a connection that stays open. Prints a table: the median of the pictures' times, in milliseconds, as the client sees them.
"""

import argparse
import http.client
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


class Pictures:
    def __init__(self, port, cloud):
        self.connection = http.client.HTTPConnection("127.0.0.1", port)
        self.path = f"/api/v1/clouds/{cloud}"

    def json(self):
        self.connection.request("GET", self.path)
        return json.loads(self.connection.getresponse().read())

    def time(self, words):
        """Milliseconds of one snapshot."""
        begin = time.perf_counter()
        self.connection.request("GET", f"{self.path}/snapshot.jpg?width=1280&height=720&samples=1&{words}")
        answer = self.connection.getresponse()
        body = answer.read()
        if answer.status != 200:
            raise SystemExit(f"{words}: {answer.status} {body[:300]}")
        return 1000 * (time.perf_counter() - begin)


def measure(pictures, column, rounds):
    low, high = column["range"]
    width = high - low
    name = column["name"]
    views = {
        "without": "",
        "filter, half of the points": f"&filter={name}:{low + width / 4!r}..{high - width / 4!r}",
        "filter, nearly all": f"&filter={name}:{low + width * 0.001!r}..",
        "colour": f"&color=column:{name}",
    }
    print(f"{'view':34} {'first, ms':>10} {'then, ms':>10}")
    for label, words in views.items():
        # Quality changes no more than the encoder's work, and makes each picture another one.
        first = pictures.time(f"quality=95{words}")
        then = [pictures.time(f"quality={60 + i % 30}&detail={1 + 0.001 * i!r}{words}") for i in range(rounds)]
        print(f"{label:34} {first:10.0f} {statistics.median(then):10.0f}")
    steps = [pictures.time(f"filter={name}:{low + width * (0.3 + 0.01 * i)!r}..") for i in range(rounds)]
    print(f"{'a slider, step by step':34} {statistics.median(steps):10.0f}")


def main():
    options = argparse.ArgumentParser()
    options.add_argument("scancast")
    options.add_argument("--points", default="5M")
    options.add_argument("--memory-limit", default="2G")
    options.add_argument("--backend", default="cpu")
    options.add_argument("--rounds", type=int, default=11)
    given = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scan, plain, kept = (os.path.join(folder, name) for name in ("town.las", "plain.scan", "kept.scan"))
        run(given.scancast, "generate", "town", "--points", given.points, "--format", "las14", "-o", scan)
        for target, flags in ((plain, ()), (kept, ("--keep-attributes",))):
            begin = time.perf_counter()
            run(given.scancast, "ingest", scan, "-o", target, *flags)
            print(f"{os.path.basename(target)}: {os.path.getsize(target) / 1e6:.1f} MB, ingested in {time.perf_counter() - begin:.1f} s")
        server = subprocess.Popen([given.scancast, "serve", kept, "--listen", "127.0.0.1:0", "--backend", given.backend,
                                   "--memory-limit", given.memory_limit], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        try:
            port = None
            for line in server.stdout:
                found = re.search(r"http://127\.0\.0\.1:(\d+)", line)
                if found:
                    port = int(found.group(1))
                    break
            if port is None:
                raise SystemExit("the server did not start")
            pictures = Pictures(port, "kept")
            for _ in range(100):
                cloud = pictures.json()
                if cloud.get("state") == "ready":
                    break
                time.sleep(0.1)
            columns = {column["name"]: column for column in cloud["columns"]}
            for name, column in columns.items():
                print(f"column {name}: {column['range']}, drawn {column['drawn']}")
            varied = [column for column in columns.values() if column["drawn"] and column["range"][0] < column["range"][1]]
            measure(pictures, varied[0], given.rounds)
        finally:
            server.terminate()
            server.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
