#!/usr/bin/python3
"""What a server needs: memory for its clouds, processor time and bandwidth for each person who moves, by method. For docs/scaling.md.

    tests/load/sizing.py --file town.scan [--bin build/release/bin] [--methods point,hqs,…] [--seconds 5] [--rounds 3] [--size 1280x720] [--json FILE]

One moving session at a time, 30 frames a second wanted, at the quality that the server can keep up; what it takes of the processor is the server's
alone (/proc), though the client runs on the same machine. Medians of the rounds, which go through all methods in turn.
"""
import argparse
import json
import os
import re
import statistics
import tempfile

import serving

MB = 1e6
METHODS = ["point", "square", "paraboloid", "hqs", "disc", "ewa", "voronoi", "pyramid"]


def metric(server, name):
    """Of /metrics, all labels added up."""
    text = server.get("/metrics")[2].decode()
    return sum(float(value) for value in re.findall(rf"^{name}(?:\{{[^}}]*\}})? (\S+)$", text, re.M))


def memory(server, on_disk):
    """Everything read into memory, by looking at it from everywhere as finely as it goes."""
    empty = server.resident()
    view = json.loads(server.get(f"/api/v1/clouds/{server.cloud}")[2])["view"]["camera"]
    points = json.loads(server.get(f"/api/v1/clouds/{server.cloud}")[2])["points"]
    started = metric(server, "scancast_points_resident")
    for up in ("0,0,1", "0,1,0"):
        eye, target = view["eye"], view["target"]
        place = ",".join(str(t + 0.5 * (e - t)) for e, t in zip(eye, target))
        server.get(server.snapshot(f"width=1920&height=1080&detail=0&samples=1&method=point&eye={place}&target={','.join(map(str, target))}&up={up}"))
    held, count = metric(server, "scancast_residency_bytes"), metric(server, "scancast_points_resident")
    print(f"{points / 1e6:.2f} million points: {on_disk / points:.1f} bytes each on disk; {started / 1e6:.2f} million in memory at the start, then "
          f"{count / 1e6:.2f} million, {held / max(count, 1):.1f} bytes each ({held / MB:.0f} MB); the process has {empty / MB:.0f} MB with the upper levels alone, "
          f"{server.resident() / MB:.0f} MB with these")
    return {"points": points, "bytesOnDisk": on_disk, "pointsInMemory": count, "bytesInMemory": held, "processAtStart": empty,
            "process": server.resident()}


def moving(client, server, method, arguments):
    width, height = arguments.size.split("x")
    before = metric(server, "scancast_frame_bytes_sum"), metric(server, "scancast_frame_bytes_count")
    groups, sampler = serving.bench(client, server, "--moving", 1, "--seconds", arguments.seconds, "--method", method, "--width", width, "--height", height)
    group = groups["moving"]
    frames = group["framesPerSecond"]["p50"]
    size = (metric(server, "scancast_frame_bytes_sum") - before[0]) / max(1, metric(server, "scancast_frame_bytes_count") - before[1])
    return {"frames": frames, "cores": sampler.cpu_share(), "frameMs": 1000 * sampler.cpu_share() / frames if frames else 0, "frameKb": size / 1000,
            "mbits": size * 8 * frames / 1e6, "resolution": group["resolution"]["p50"], "detail": group["detail"]["p50"]}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--file", required=True, help="a cloud file")
    parser.add_argument("--bin", default="build/release/bin", help="folder of the programs")
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--seconds", type=float, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--json", help="write the figures there, too")
    arguments = parser.parse_args()
    scancast, client = (os.path.join(arguments.bin, name) for name in ("scancast", "scancast-client"))
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "log"), "w+", encoding="utf-8") as log:
        server = serving.Server(scancast, arguments.file, 8, log, "--backend", "cpu", "--memory-limit", "8G")
        try:
            figures = {"memory": memory(server, os.path.getsize(arguments.file)), "methods": {}}
            rounds = {}
            for _ in range(arguments.rounds):
                for method in arguments.methods.split(","):
                    rounds.setdefault(method, []).append(moving(client, server, method, arguments))
        finally:
            server.stop()
    print("| | frames/s | resolution | detail, px | processor time a frame, ms | cores | kB a frame | Mbit/s |\n|---|---|---|---|---|---|---|---|")
    for method, runs in rounds.items():
        median = {key: statistics.median(run[key] for run in runs) for key in runs[0]}
        figures["methods"][method] = median
        print(f"| `{method}` | {median['frames']:.0f} | {median['resolution']:.2f} | {median['detail']:.1f} | {median['frameMs']:.0f} | {median['cores']:.2f} | "
              f"{median['frameKb']:.0f} | {median['mbits']:.0f} |")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump(figures, file, indent=2)


if __name__ == "__main__":
    main()
