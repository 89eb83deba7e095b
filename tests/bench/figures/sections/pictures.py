"""What pictures are like: against the truth, in motion, device against device."""
import csv
import io
import json
import os
import re

from ..bench import METHODS, Failed, run
from ..words import number, table

SCENES = ["sign", "torus", "cube", "plane", "statue", "bridge", "town"]


def measure_truth(bench):
    small = ["--scenes", "plane", "--points", "2000", "--width", "160", "--steps", "1", "--repeat", "1", "--methods", "point,ewa"] if bench.quick \
        else ["--scenes", ",".join(SCENES), "--methods", ",".join(METHODS), "--steps", "10", "--repeat", "3"]
    return {"rows": truth_of(run([bench.tool("compare_methods"), "--csv", *small]))}


def truth_of(text):
    """Of compare_methods --csv, those columns that the page has."""
    kept = ("scene", "method", "psnr", "ssim", "holes_percent", "turned", "levels_worst")
    return [{key: row[key] for key in kept} for row in csv.DictReader(io.StringIO(text))]


def truth_page(data):
    scenes, methods = ([*dict.fromkeys(row[key] for row in data["rows"])] for key in ("scene", "method"))
    at = {(row["scene"], row["method"]): row for row in data["rows"]}
    cell = lambda row, *keys: "-" if row is None else ", ".join(f"{float(row[key]):.{digits}f}{unit}" for key, digits, unit in keys)
    of = lambda *keys: [[scene, *(cell(at.get((scene, method)), *keys) for method in methods)] for scene in scenes]
    head = ["", *(f"`{method}`" for method in methods)]
    return "\n\n".join(["PSNR in dB, holes:", table(head, of(("psnr", 1, ""), ("holes_percent", 2, " %"))), "SSIM:", table(head, of(("ssim", 3, ""))),
                        "Pixels that change by more than 16 of 255 in an orbit by 0.1°, per cent; in brackets those of changes of level alone, in the worst step:",
                        table(head, [[scene, *(f"{float(at[scene, m]['turned']):.2f} ({float(at[scene, m]['levels_worst']):.2f})" if (scene, m) in at else "-"
                                               for m in methods)] for scene in scenes])])


MOVING = ["copc/lion_takanawa.copc.laz", "ply/guanyin-statue.ply", "laz/strand-statue-1m.laz"]


def moved(bench, scans, methods, samples, steps, *more):
    return moves_of(run([bench.tool("bench_stability"), *(word for scan in scans for word in ("--cloud", bench.data(scan))), "--method", methods, "--motion", "orbit",
                "--no-brute-force", "--distance", "0.5", "--shading", "unlit", "--samples", samples, "--steps", str(steps), *more]))


def moves_of(text):
    """Its table: {(scan, method, samples): per cent of the pixels that change}."""
    rows = re.findall(r"(?m)^(\S+)\s+(\w+)\s+\S+\s+orbit\s+\S+\s+(\d+)\s+([\d.]+)\s", text)
    if not rows:
        raise Failed(f"bench_stability tells no row: {text[:200]}")
    return {(scan, method, int(count)): float(mean) for scan, method, count, mean in rows}


def measure_moves(bench):
    scans = MOVING[1:2] if bench.quick else MOVING
    hard = moved(bench, scans, "square,hqs,paraboloid", "1", 2 if bench.quick else 60)
    many = moved(bench, scans, "paraboloid", "4" if bench.quick else "64", 1 if bench.quick else 4)
    smooth = moved(bench, scans, "paraboloid", "1", 2 if bench.quick else 60, "--param", "smooth=true")
    column = lambda found, method, scan: next((value for (s, m, _), value in found.items() if s == os.path.basename(scan) and m == method), None)
    return {"rows": [[os.path.basename(scan), column(hard, "square", scan), column(hard, "hqs", scan), column(hard, "paraboloid", scan),
                      column(smooth, "paraboloid", scan), column(many, "paraboloid", scan)] for scan in scans]}


def moves_page(data):
    return table(["", "`square`", "`hqs`", "`paraboloid`", "with `smooth=true`", "64 samples"], [[f"`{row[0]}`", *row[1:]] for row in data["rows"]])


def measure_agreement(bench):
    told_to = bench.path("agreement.json")
    small = ["--scenes", "town", "--points", "2000", "--width", "64", "--repeat", "1", "--methods", "point", "--backends", "egl"] if bench.quick \
        else ["--points", "50000", "--width", "320", "--repeat", "1"]
    bench.log(run([bench.tool("compare_devices"), "--json", told_to, *small]))
    with open(told_to, encoding="utf-8") as file:
        return {"rows": json.load(file)}


def agreement_page(data):
    rows = []
    for backend in dict.fromkeys(row["backend"] for row in data["rows"]):
        own = [row for row in data["rows"] if row["backend"] == backend]
        least = min((row["psnrDb"] for row in own if row["psnrDb"] is not None), default=None)
        rows.append([f"`{backend}`", len(own), sum(row["sameBytes"] for row in own), "infinite" if least is None else f"{number(least)} dB"])
    return table(["device", "pictures", "the `cpu` device's, byte by byte", "the least alike, colours"], rows)
