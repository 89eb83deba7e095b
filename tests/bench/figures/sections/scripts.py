"""Figures that a benchmark of tests/bench or tests/load tells by itself (told.py): asked with the sizes of this run, and put into tables."""
import json
import os

from ..bench import run
from ..words import number, spread, table, told_table, with_unit


# ---- beside VTK

def measure_vtk(bench, backend="cpu"):
    sizes = ["--points", 20000, "--rounds", 1] if bench.quick else []
    bandwidth = ["--bandwidth", bench.tool("memory_bandwidth")]
    return {"backend": backend, "rows": bench.script("vs_vtk.py", "--bin", bench.given.bin, "--backend", backend, *sizes, *bandwidth),
            "version": run(["/usr/bin/python3", "-c", "import vtk; print(vtk.vtkVersion.GetVTKVersion())"]).strip()}


def vtk_page(data):
    rows, on_cpu = [], data["backend"] == "cpu"
    for row in data["rows"]:
        share = f"{100 * row['rate'] * 16 / (row['bandwidth'] * 1000):.1f} % of {number(row['bandwidth'])} GB/s / 16 B" if row.get("bandwidth") else "not measured"
        promised = "" if row.get("least") is None else f"at least {row['least']} x" + ("" if row["reached"] else ": **missed**")
        rows.append([f"`{row['name'].split()[0]}`{row['name'][len(row['name'].split()[0]):]}", f"{number(row['oursMs'])} ms, {number(row['points'] / row['oursMs'] / 1000)} Mpts/s",
                     f"{number(row['theirsMs'])} ms, {number(row['points'] / row['theirsMs'] / 1000)} Mpts/s",
                     f"**{number(row['value'])} x** ({number(row['low'])} - {number(row['high'])})", promised, *([share] if on_cpu else [])])
    head = ["", "Scancast" if on_cpu else f"Scancast, `{data['backend']}`", f"VTK {data['version']}", "ratio (lowest - highest round)", "promised"]
    return table(head + (["of the memory bandwidth"] if on_cpu else []), rows)


def measure_gl(bench):
    return measure_vtk(bench, "egl")


# ---- the town

def measure_town(bench):
    return {"rows": bench.script("town.py", "--bin", bench.given.bin, "--points", bench.points)}


def plain_page(data):
    return told_table(data["rows"])


# ---- cloud files

def measure_ingest(bench):
    rows = bench.script("ingest.py", "--bin", bench.given.bin, "--points", bench.points, "--rounds", bench.rounds, "--folder", bench.folder)
    scans = [bench.town_las()]
    real = bench.data("laz/autzen-stadium-10m.laz")
    scans += [real] if os.path.exists(real) and not bench.quick else []
    first = bench.script("first_picture.py", "--scancast", bench.scancast, *scans)
    return {"points": bench.points, "rows": rows, "first": first}


def ingest_page(data):
    rows = [[row["name"], spread(row), f"{row['peakBytes'] / 1e6:.0f} MB", f"{row['bytesAPoint']:.1f}"] for row in data["rows"]]
    first = [[row["name"], with_unit(row["value"], "s"), f"{row['points']:,}", with_unit(row["wholeSeconds"], "s"), f"{row['wholePoints']:,}"] for row in data["first"]]
    return "\n\n".join([f"A town of {data['points'] / 1e6:g} million points, LAS, median (lowest - highest):", table(["", "", "peak", "bytes a point on disk"], rows),
                        "Seconds from the start of `serve` to the first picture of a scan that it has yet to read, and to the whole scan:",
                        table(["scan", "first picture", "of so many points", "whole", "points"], first)])


# ---- a billion points

def measure_billion(bench):
    points = "100k" if bench.quick else "1G"
    return {"points": points, "rows": bench.script("ingest.py", "--bin", bench.given.bin, "--large", points, "--memory-limit", "4G", "--no-surfels",
                                                   "--folder", bench.folder, "--frames", 4 if bench.quick else 360)}


def billion_page(data):
    return f"A town of {data['points']} points, `generate | ingest --memory-limit 4G --no-surfels`, then served under the same limit.\n\n" + told_table(data["rows"])


# ---- points over HTTP

def measure_http(bench):
    small = ["--rounds", 1, "--length", 100] if bench.quick else ["--rounds", 5]
    return {"points": bench.points, "rows": bench.script("export/points.py", bench.town(), "--scancast", bench.scancast, *small)}


def http_page(data):
    rows = [[row["name"], f"{row['points']:,}" if "points" in row else "", spread(row), f"{row['bytes'] / row['value'] / 1e6:,.0f} MB/s" if row.get("bytes") else ""]
            for row in data["rows"]]
    return f"A town of {data['points'] / 1e6:g} million points.\n\n" + table(["", "points", "median (lowest - highest)", ""], rows)


# ---- streams under load

def measure_load(bench):
    from ..bench import HERE
    told_to = bench.path("load.json")
    command = ["/usr/bin/python3", os.path.join(HERE, "..", "load", "load.py"), "--bin", bench.given.bin, "--file", bench.town(), "--json", told_to]
    bench.log(run(command + (["--quick", "--only", "moving"] if bench.quick else [])))
    with open(told_to, encoding="utf-8") as file:
        return {"rows": json.load(file)["figures"]}


def load_page(data):
    parts = {}
    for row in data["rows"]:
        parts.setdefault(row.get("part", ""), []).append(row)
    return "\n\n".join((f"**{part}**\n\n" if part else "") + told_table(rows) for part, rows in parts.items())


# ---- depth with every frame

def measure_depth(bench):
    small = ["--frames", 3, "--rounds", 1, "--size", "160x90"] if bench.quick else []
    return {"points": bench.points, "rows": bench.script("live/depth.py", bench.town(), "--bin", bench.given.bin, *small)}


def depth_page(data):
    return f"The town of {data['points'] / 1e6:g} million points; processor time of the server for a frame: drawn, encoded and sent.\n\n" + told_table(data["rows"])
