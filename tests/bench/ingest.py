#!/usr/bin/python3
"""How fast scans become cloud files, how much memory and disk that takes, and how such a cloud is to look at.

    tests/bench/ingest.py [--bin build/release/bin] [--points 20M] [--rounds 3] [--folder DIR]
    tests/bench/ingest.py --large 200M --memory-limit 2G
    tests/bench/ingest.py --large 1G --memory-limit 2G --serve-limit 20G --no-surfels
    tests/bench/ingest.py --scan SCAN.laz

The first form generates a town and ingests it, with surfels and without, in turn; prints points/s (medians).
The second pipes a generated town into `ingest` and prints peak resident memory, bytes a point on disk; then serves it:
seconds until the cloud file is open and until the first picture, an orbit through the live stream at 1280 x 720 with
moving quality: median frames/s, the slowest frame, resident memory. The third does so with a real scan.
Peak memory is what the kernel counts as the process's largest resident set.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import tempfile
import time
import urllib.error
import urllib.request

from figures import told


def megabytes(size):
    return f"{size / 1e6:.0f} MB"


def timed(command, stdin=None):
    """Runs to the end; returns seconds, peak resident bytes and the last line on standard error."""
    start = time.monotonic()
    with tempfile.TemporaryFile() as errors:
        process = subprocess.Popen(command, stdin=stdin, stdout=subprocess.DEVNULL, stderr=errors)
        if stdin:
            stdin.close()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        lines = errors.read().decode(errors="replace").strip().splitlines()
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}: {lines[-1] if lines else ''}")
    return time.monotonic() - start, usage.ru_maxrss * 1024, lines[-1] if lines else ""


def count(text):
    factors = {"k": 1e3, "M": 1e6, "G": 1e9}
    return int(float(text.rstrip("kMG")) * factors.get(text[-1], 1))


def speeds(scancast, points, rounds, folder, sheet):
    las, scan = os.path.join(folder, "town.las"), os.path.join(folder, "town.scan")
    subprocess.run([scancast, "generate", "town", "--points", points, "-o", las, "--quiet"], check=True)
    rates, last = {"without surfels": [], "with surfels": []}, {}
    for _ in range(rounds):
        for name, flags in (("without surfels", ["--no-surfels"]), ("with surfels", [])):
            seconds, peak, _ = timed([scancast, "ingest", las, "-o", scan, "--force", *flags])
            rates[name].append(count(points) / seconds / 1e6)
            last[name] = peak, os.path.getsize(scan) / count(points)
            print(f"  {name}: {seconds:.1f} s, peak {megabytes(peak)}, {os.path.getsize(scan) / count(points):.1f} bytes a point")
    for name, values in rates.items():
        print(f"ingest {name}, {points} points, LAS in: {statistics.median(values):.2f} M points/s "
              f"(median of {rounds}; {min(values):.2f}-{max(values):.2f})")
        sheet.figure(f"ingest {name}", statistics.median(values), "M points/s", low=min(values), high=max(values), points=count(points),
                     peakBytes=last[name][0], bytesAPoint=last[name][1])


def large(scancast, points, limit, surfels, folder, sheet):
    scan = os.path.join(folder, "large.scan")
    flags = [] if surfels else ["--no-surfels"]
    generator = subprocess.Popen([scancast, "generate", "town", "--points", points, "--format", "las14", "-o", "-", "--quiet"],
                                 stdout=subprocess.PIPE)
    seconds, peak, _ = timed([scancast, "ingest", "-", "-o", scan, "--force", "--memory-limit", limit, *flags],
                             stdin=generator.stdout)
    generator.wait()
    size = os.path.getsize(scan)
    print(f"generate | ingest --memory-limit {limit}{'' if surfels else ' --no-surfels'}, {points} points: {seconds:.0f} s "
          f"({count(points) / seconds / 1e6:.2f} M points/s with the generator beside it), peak resident {megabytes(peak)}, "
          f"{size / 1e9:.2f} GB = {size / count(points):.1f} bytes a point")
    sheet.figure("time, the generator beside it", seconds, "s")
    sheet.figure("that is", count(points) / seconds / 1e6, "M points/s")
    sheet.figure(f"peak, of a limit of {limit}", peak / 1e6, "MB")
    sheet.figure("on disk", size / 1e9, "GB")
    sheet.figure("bytes a point on disk", size / count(points))
    return scan


def resident(process):
    with open(f"/proc/{process.pid}/status") as status:
        return int(re.search(r"VmHWM:\s+(\d+)", status.read()).group(1)) * 1024


def look(scancast, client, scan, limit, folder, frames, sheet):
    start = time.monotonic()
    server = subprocess.Popen([scancast, "serve", scan, "--port", "0", "--memory-limit", limit],
                              stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        url = re.search(r"http://[^/]+", server.stdout.readline()).group(0)
        cloud = None
        while not cloud:
            clouds = json.load(urllib.request.urlopen(f"{url}/api/v1/clouds"))["clouds"]
            cloud = clouds[0]["id"] if clouds else None
            time.sleep(0.005)
        print(f"serve: open {time.monotonic() - start:.2f} s after the start")
        sheet.figure("served: open after", time.monotonic() - start, "s")
        out = subprocess.run([client, "orbit", url, "--frames", "1", "--moving", "--width", "1280", "--height", "720", "-o", folder],
                             check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        print(f"serve: first picture {time.monotonic() - start:.2f} s after the start")
        sheet.figure("served: first picture after", time.monotonic() - start, "s")
        urllib.request.urlopen(f"{url}/api/v1/clouds/{cloud}/snapshot.jpg?width=1280&height=720").read()
        print(f"serve: first picture at full quality {time.monotonic() - start:.2f} s after the start")
        sheet.figure("served: first picture at full quality after", time.monotonic() - start, "s")
        for turn in ("first", "second"):
            out = subprocess.run([client, "orbit", url, "--frames", str(frames), "--moving", "--width", "1280", "--height", "720",
                                  "-o", folder], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            told_orbit = out.stdout.strip().splitlines()[-1].split(", in ")[0]
            sheet.figure(f"its orbit, live stream, moving quality, {frames} frames, {turn} turn", told_orbit)
            print(f"orbit, {turn} turn, --memory-limit {limit}: {told_orbit}")
        print(f"serve: peak resident {megabytes(resident(server))}")
        sheet.figure("served: peak", resident(server) / 1e6, "MB")
    finally:
        server.terminate()
        server.wait(30)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    parser.add_argument("--bin", default=os.path.join(root, "build/release/bin"), help="folder of the scancast programs")
    parser.add_argument("--points", default="20M", help="of the town for the speeds")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--large", metavar="N", help="a town of N points, piped into ingest, then served")
    parser.add_argument("--scan", help="a scan, ingested and served")
    parser.add_argument("--cloud", help="a cloud file that is there already, only served")
    parser.add_argument("--memory-limit", default="2G")
    parser.add_argument("--serve-limit", help="the server's; by default the same")
    parser.add_argument("--no-surfels", action="store_true")
    parser.add_argument("--frames", type=int, default=360, help="of an orbit")
    parser.add_argument("--folder", help="where to work; by default a temporary folder")
    told.add_option(parser)
    arguments, sheet = parser.parse_args(), told.Told()
    scancast, client = (os.path.join(arguments.bin, name) for name in ("scancast", "scancast-client"))
    serve_limit = arguments.serve_limit or arguments.memory_limit
    print(f"{os.cpu_count()} cores")
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        if arguments.large:
            scan = large(scancast, arguments.large, arguments.memory_limit, not arguments.no_surfels, folder, sheet)
            look(scancast, client, scan, serve_limit, folder, arguments.frames, sheet)
        elif arguments.cloud:
            look(scancast, client, arguments.cloud, serve_limit, folder, arguments.frames, sheet)
        elif arguments.scan:
            scan = os.path.join(folder, "real.scan")
            seconds, peak, last = timed([scancast, "ingest", arguments.scan, "-o", scan, "--memory-limit", arguments.memory_limit,
                                         *(["--no-surfels"] if arguments.no_surfels else [])])
            print(f"{os.path.basename(arguments.scan)}: {last.split(': ', 1)[-1]}, peak resident {megabytes(peak)}")
            sheet.figure("ingest", seconds, "s", peakBytes=peak)
            look(scancast, client, scan, serve_limit, folder, arguments.frames, sheet)
        else:
            speeds(scancast, arguments.points, arguments.rounds, folder, sheet)
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
