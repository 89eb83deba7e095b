#!/usr/bin/env python3
"""How fast points leave a server: exports of all of a cloud, in each format, and profiles along a folded line of a kilometre;
with the memory that the server had at the most. Reads and forgets, as fast as it comes.

    tests/bench/export/points.py CLOUD.scan [--memory-limit 2G] [--most 10000000] [--rounds 3] [--json FILE]
"""
import argparse
import json
import os
import sys
import tempfile
import time

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

sys.path.insert(0, os.path.join(ROOT, "tests", "bench"))
from figures import told


def folded_line(low, high, length, margin=0.05):
    """To and fro across the cloud's plan, until it is that long."""
    spans = [(h - l) * margin for l, h in zip(low, high)]
    (x0, y0), (x1, y1) = [l + s for l, s in zip(low, spans)], [h - s for h, s in zip(high, spans)]
    rows = max(1, int(length / (x1 - x0)) + 1)
    line, left = [], length
    for row in range(rows + 1):
        y = y0 + (y1 - y0) * row / max(rows, 1)
        ends = [(x0, y), (x1, y)] if row % 2 == 0 else [(x1, y), (x0, y)]
        for place in ends:
            if line:
                step = sum((a - b) ** 2 for a, b in zip(place, line[-1])) ** 0.5
                if step > left:
                    share = left / step
                    line.append([a + (b - a) * share for a, b in zip(line[-1], place)])
                    return line
                left -= step
            line.append(list(place))
    return line


def timed(server, what, body):
    """Seconds, bytes, points as its head says."""
    connection = server.connect()
    begun = time.monotonic()
    connection.request("POST", f"/api/v1/clouds/{server.cloud}/{what}", body=json.dumps(body), headers={"Content-Type": "application/json"})
    answer = connection.getresponse()
    if answer.status != 200:
        raise SystemExit(f"{what}: {answer.status} {answer.read().decode()[:500]}")
    size, lines = 0, 0
    while data := answer.read(1 << 20):
        size += len(data)
        lines += data.count(b"\n") if body["format"] == "csv" else 0
    said = answer.headers.get("Scancast-Points") or json.loads(answer.headers.get("Scancast-Profile") or "{}").get("points") or lines - 1
    connection.close()
    return time.monotonic() - begun, size, int(said)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("cloud")
    parser.add_argument("--scancast", default=os.path.join(ROOT, "build/release/bin/scancast"))
    parser.add_argument("--memory-limit", default="")
    parser.add_argument("--most", type=float, default=1e7, help="points of an export: larger clouds are cut in x to about so many")
    parser.add_argument("--length", type=float, default=1000, help="of the profile's line")
    parser.add_argument("--width", type=float, default=1)
    parser.add_argument("--rounds", type=int, default=3)
    told.add_option(parser)
    arguments, sheet = parser.parse_args(), told.Told()
    flags = ["--memory-limit", arguments.memory_limit] if arguments.memory_limit else []
    with tempfile.TemporaryFile() as log:
        server = serving.Server(arguments.scancast, arguments.cloud, 4, log, *flags)
        cloud = json.loads(server.get(f"/api/v1/clouds/{server.cloud}")[2])
        low, high = cloud["bounds"]["min"], cloud["bounds"]["max"]
        region = {}
        if cloud["points"] > arguments.most:
            share = arguments.most / cloud["points"]
            region = {"clip": {"min": [l - 1 for l in low], "max": [low[0] + (high[0] - low[0]) * share, high[1] + 1, high[2] + 1]}}
        print(f"{server.cloud}: {cloud['points']:,} points")
        line = folded_line(low[:2], high[:2], arguments.length)
        rows = [("points", {"format": form, "region": region}) for form in ("las", "ply", "csv")]
        profile = {"line": line, "width": arguments.width}
        rows += [("profile", {**profile, "format": form}) for form in ("csv", "ply", "las")]
        rows += [("profile", {**profile, "format": "png"})]
        most = server.resident()
        for what, body in rows:
            times = []
            for _ in range(arguments.rounds):
                seconds, size, points = timed(server, what, body)
                times.append(seconds)
                most = max(most, server.resident())
            best = sorted(times)[len(times) // 2]
            print(f"{what:8} {body['format']:4} {points:>12,} points {size / 1e6:9.1f} MB {best:7.2f} s {points / best / 1e6:7.2f} M points/s")
            sheet.figure(f"{what}, {body['format'].upper()}", best, "s", low=min(times), high=max(times), points=points, bytes=size)
        print(f"resident at the most {most / 1e6:.0f} MB")
        sheet.figure("the server's memory at the most", most / 1e6, "MB")
        server.stop()
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
