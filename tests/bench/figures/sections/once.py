"""What takes a graphics card, or has been run before: a day of gpu_day.sh, what ./test.sh printed."""
import json
import os
import re

from .. import machine
from ..bench import HERE, Failed, run
from ..words import table

PARTS = ("device", "compare", "10m", "10m-direct-sums", "100m-points", "100m-surfels", "796m")


def measure_gpu(bench):
    folder = bench.given.gpu_results or bench.path("gpu_day")
    if not bench.given.gpu_results:
        programs = os.path.join(bench.build, "bench_gpu")
        bench.log(run(["bash", os.path.join(HERE, "gpu_day.sh"), "--out", folder, "--programs", programs, *(["--quick"] if bench.quick else []), "all"]))
    found = {}
    for part in PARTS:
        try:
            with open(os.path.join(folder, part + ".json"), encoding="utf-8") as file:
                found[part] = json.load(file)
        except (OSError, ValueError):
            continue
    if not found:
        raise Failed(f"{folder} has no results of gpu_day.sh")
    return {"parts": found, "elsewhere": bool(bench.given.gpu_results)}


def gpu_page(data):
    parts, lines, marks = data["parts"], [], {}
    device = next((part for part in parts.values() if isinstance(part, dict)), None)
    if device:
        lines.append(f"**{device['renderer']}**, {device['driver']}" + (", by `gpu_day.sh` on another machine, of whose commit its folder tells" if data["elsewhere"] else "") + ".")
    if compared := parts.get("compare"):
        lines.append(f"Of `compare_devices`' {len(compared)} pictures {sum(row['sameBytes'] for row in compared)} are the `cpu` device's, byte by byte.")
    rows = []
    for name, part in parts.items():
        direct = name.endswith("-direct-sums")  # to be set beside the others; no mark is theirs
        for cloud in part.get("clouds", []) if name != "device" and isinstance(part, dict) else []:
            for row in cloud["rows"]:
                if "gpuMs" in row:
                    brute = ", brute force" if row.get("bruteForce") else ", sums not in shared memory first" if direct else ""
                    rows.append([f"{cloud['points'] / 1e6:g} M points", f"`{row['method']}`{brute}", f"{row['width']} x {row['height']}", row["samples"] / 1e6, row["gpuMs"],
                                 row["hostMs"], row["frameMs"], row["jpegMs"]])
                for mark in [] if direct else row.get("marks", []):
                    marks[mark["what"], row["method"], cloud["points"]] = mark
    lines.append("Milliseconds; GPU = all passes, frame = from the view to pixels in main memory, JPEG = and encoded.")
    lines.append(table(["town", "method", "size", "million samples", "GPU", "host", "frame", "JPEG"], rows))
    if marks:
        lines.append(table(["what", "wanted, ms", "measured, ms"], [[what, mark.get("published") or f"at most {mark['mostMs']:g}",
                     f"{mark['measuredMs']:.2f}" + ("" if mark.get("met", True) else ": **missed**")] for (what, _, _), mark in marks.items()]))
    return "\n\n".join(lines)


def tests_log(bench):
    """A need."""
    return None if bench.given.tests_log else "it takes more than an hour by itself: `./test.sh 2> tests.log`, then this command with `--tests-log tests.log`"


def measure_tests(bench):
    text = machine.read(bench.given.tests_log)
    rows = re.findall(r"(?m)^([a-z]+(?:: [a-z]+)?)\s+(\d+) s,\s+(\d+) s of processor time", text)
    if not rows:
        raise Failed(f"{bench.given.tests_log} has no such lines as ./test.sh prints at its end: 'release: build   400 s,  748 s of processor time'")
    return {"rows": [[name, int(clock), int(cpu)] for name, clock, cpu in rows]}


def tests_page(data):
    total = ["**all of them but installation**", *(sum(row[i] for row in data["rows"] if row[0] != "installation") for i in (1, 2))]
    return table(["part", "on the clock, s", "processor time, s"], [*data["rows"], total])
