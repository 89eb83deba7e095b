"""The same town in each format that can be made here, read by ingest."""
import os
import re
import resource
import subprocess
import time

from ..bench import Failed, run
from ..words import table

POINTS = 10_000_000


def ingested(command):
    """(seconds, of processor time of it and its importer, peak bytes of the larger, the points that it tells of, or nothing)."""
    before, begun = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, errors="replace") as process:
        said = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise Failed(f"ingest of {os.path.basename(command[2])}: {said.strip().splitlines()[-1]}")
    seconds, after = time.monotonic() - begun, resource.getrusage(resource.RUSAGE_CHILDREN)
    count = re.search(r"([\d,]+) points", said)
    return seconds, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, usage.ru_maxrss * 1024, int(count[1].replace(",", "")) if count else None


PCD = """# .PCD v0.7 - Point Cloud Data file format
VERSION 0.7
FIELDS x y z rgb
SIZE 4 4 4 4
TYPE F F F U
COUNT 1 1 1 1
WIDTH {0}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {0}
DATA binary
"""
# Of PLY's floats and colours, by /usr/bin/python3, which has Debian's numpy.
WRITE_PCD = """
import sys, numpy
sys.path.insert(0, sys.argv[1])
from vs_vtk import read_ply
xyz, rgb = read_ply(sys.argv[2])
rows = numpy.empty(len(xyz), dtype=[("xyz", "<f4", 3), ("rgb", "<u4")])
rows["xyz"], rows["rgb"] = xyz, (rgb.astype("u4") * (65536, 256, 1)).sum(axis=1)
with open(sys.argv[3], "wb") as out:
    out.write(sys.argv[4].format(len(xyz)).encode())
    rows.tofile(out)
"""


def written(bench, points):
    """Yields (name, path, None) of each format, or (name, None, why it cannot be made); one at a time, and away when it was read: they are large."""
    from ..bench import HERE
    path, made, las = bench.path("format"), [bench.scancast, "generate", "town", "--points", str(points), "--quiet", "-o"], bench.town_las(points)
    yield "LAS", las, None
    run([*made, path + ".ply"])
    yield "PLY, floats, colour", path + ".ply", None
    try:
        run(["/usr/bin/python3", "-c", WRITE_PCD, HERE, path + ".ply", path + ".pcd", PCD])
        yield "PCD, floats, packed colour", path + ".pcd", None
        os.remove(path + ".pcd")
    except Failed as problem:
        yield "PCD", None, f"it is written with Debian's python3-numpy ({problem})"
    for name, ending, form in (("PLY, doubles", ".ply", "ply"), ("CSV, as `scancast export` writes it", ".csv", "csv"), ("XYZ, the same columns", ".xyz", "txt")):
        run([bench.scancast, "export", las, "-o", path + ending, "--format", form, "--force", "--quiet"])
        yield name, path + ending, None
        os.remove(path + ending)
    tool = bench.tool("write_e57")
    if os.path.exists(tool):
        run([tool, path + ".e57", "--points", str(points), "--encoding", "scaled", "--scans", "4"])
        yield "E57, scaled integers, 4 scans of a terrain (`write_e57`)", path + ".e57", None
        os.remove(path + ".e57")
    else:
        yield "E57", None, "`write_e57` is not built (`-DSCANCAST_BENCH=ON`)"
    laz = bench.data("laz/autzen-stadium-10m.laz")
    yield ("LAZ (autzen-stadium)", laz, None) if os.path.exists(laz) and not bench.quick else ("LAZ", None, "no laz/autzen-stadium-10m.laz beneath `--data`")


def measure_formats(bench):
    rows, points, scan = [], 2000 if bench.quick else POINTS, bench.path("format.scan")
    for name, path, why in written(bench, points):
        if why:
            rows.append({"name": name, "why": why})
            continue
        runs = [ingested([bench.scancast, "ingest", path, "-o", scan, "--no-surfels", "--force"]) for _ in range(1 if bench.quick else 3)]
        rates = sorted((count or points) / seconds / 1e6 for seconds, _, _, count in runs)
        rows.append({"name": name, "rates": rates, "cpu": min(run[1] for run in runs), "peak": max(run[2] for run in runs), "bytes": os.path.getsize(path)})
    return {"points": points, "rows": rows}


def formats_page(data):
    rows = [[r["name"], *(["not measured: " + r["why"], "", "", ""] if "why" in r else
                          [f"{r['rates'][len(r['rates']) // 2]:.2f} ({r['rates'][0]:.2f} - {r['rates'][-1]:.2f})", f"{r['cpu']:.1f} s", f"{r['peak'] / 1e6:.0f} MB",
                           f"{r['bytes'] / 1e6:.0f} MB"])] for r in data["rows"]]
    return f"A town of {data['points'] / 1e6:g} million points but where something else is said.\n\n" + table(
        ["", "M points/s, median (lowest - highest)", "processor time, both", "peak", "the file"], rows)
