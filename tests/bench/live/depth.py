#!/usr/bin/env python3
"""What depth with every frame costs: processor time of the server for a moving frame with `"depth": true` in `hello` and without, in turn.

    tests/bench/live/depth.py CLOUD.scan [--bin build/release/bin] [--frames 72] [--rounds 3] [--size 1280x720] [--json FILE]

A flight from the first view to a twentieth of its distance to what it looks at, one view a frame: the next one is asked for when the frame of the last is
there, so every frame is drawn. One sample a pixel at full resolution. What the processor does is the server's alone (/proc), though the client runs
beside it. Drawn, encoded, sent; and the bytes that the packed depth has.
"""
import argparse
import os
import statistics
import sys
import tempfile

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
sys.path[:0] = [os.path.join(ROOT, "tests", "load"), os.path.join(ROOT, "tests", "bench"), os.path.join(ROOT, "client", "python")]
import scancast  # noqa: E402
import serving  # noqa: E402
from figures import told  # noqa: E402


def flight(cloud, server, depth, frames, width, height):
    """(ms of the server's processor time a frame, bytes of packed depth of each frame)."""
    camera = cloud.facts.view["camera"]
    target, eye = camera["target"], camera["eye"]
    sizes = []
    with cloud.live(depth=depth, width=width, height=height, samples=1) as live:
        live.quality(min_resolution=1)
        live.still()
        before = server.cpu_seconds()
        for step in range(frames):
            share = 0.05 ** (step / max(1, frames - 1))
            seq = live.view(eye=tuple(t + (e - t) * share for t, e in zip(target, eye)))
            while (frame := live.frame()).seq < seq:
                pass
            if frame.depth:
                sizes.append(len(frame.depth.packed))
        return 1000 * (server.cpu_seconds() - before) / frames, sizes


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cloud", help="a cloud file")
    parser.add_argument("--bin", default=os.path.join(ROOT, "build/release/bin"), help="folder of the programs")
    parser.add_argument("--frames", type=int, default=72)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--size", default="1280x720")
    told.add_option(parser)
    arguments, sheet = parser.parse_args(), told.Told()
    width, height = map(int, arguments.size.split("x"))
    times, sizes = {False: [], True: []}, []
    with tempfile.TemporaryFile() as log:
        server = serving.Server(os.path.join(arguments.bin, "scancast"), arguments.cloud, 4, log)
        try:
            cloud = scancast.Server(server.url).cloud(server.cloud)
            flight(cloud, server, False, arguments.frames, width, height)  # reads what the flight sees
            for _ in range(arguments.rounds):
                for depth in (False, True):
                    ms, packed = flight(cloud, server, depth, arguments.frames, width, height)
                    times[depth].append(ms)
                    sizes += packed
        finally:
            server.stop()
    for depth, name in ((False, "a frame without depth, processor time"), (True, "with depth")):
        print(f"{name}: {statistics.median(times[depth]):.1f} ms ({min(times[depth]):.1f} - {max(times[depth]):.1f})")
        sheet.figure(name, statistics.median(times[depth]), "ms", low=min(times[depth]), high=max(times[depth]))
    if sizes:
        print(f"packed depth: {statistics.mean(sizes) / 1000:.1f} kB in the middle, {max(sizes) / 1000:.1f} at the most")
        sheet.figure("packed depth, mean", statistics.mean(sizes) / 1000, "kB")
        sheet.figure("packed depth, most", max(sizes) / 1000, "kB")
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
