"""How fast each method draws the town, and real scans; what papers measured, in their settings."""
import os

import methods as papers_settings

from ..bench import run, stage, without
from ..words import number, table

REAL = "laz/autzen-stadium-10m.laz"


def fast_row(bench, cloud, method):
    full = bench.turn(cloud, method)
    floor = bench.turn(cloud, method, size=(bench.size[0] // 2, bench.size[1] // 2), flags=["--detail", "2"])
    still = bench.turn(cloud, method, views=4, samples=4)
    return {"method": method, "ms": full["medianMs"], "encode": stage(full, "encode"), "samples": full["samples"], "floorMs": floor["medianMs"],
            "stillMs": still["medianMs"], "stages": {s["name"]: s["medianMs"] for s in full["stages"]}}


def measure_fast(bench):
    clouds = [(f"town, {bench.points / 1e6:g} million points", bench.town())]
    scan = bench.data(REAL)
    said = ""
    if os.path.exists(scan) and not bench.quick:
        real = bench.path("real.scan")
        if not os.path.exists(real):
            run([bench.scancast, "ingest", scan, "-o", real, "--orient", "up", "--quiet", "--force"])
        clouds.append((os.path.basename(scan), real))
    elif not bench.quick:
        said = f"There is no {REAL} beneath the folder of real scans (`--data`): only the town."
    return {"size": bench.size, "said": said,
            "clouds": [{"name": name, "rows": [fast_row(bench, cloud, method) for method in bench.methods()]} for name, cloud in clouds]}


def fast_page(data):
    width, height = data["size"]
    parts = [f"Medians of three turns, ms, from the view to the JPEG, {width} x {height}, each method at its own τ. *Moving*: {width // 2} x {height // 2} at τ = 2, the "
             "coarsest that a moving camera gets. *Still*: four samples a pixel, as snapshots have."]
    for cloud in data["clouds"]:
        wanted = {r["method"]: 1000 / papers_settings.MARKS[r["method"]] for r in cloud["rows"]}
        rows = [[f"`{r['method']}`", r["ms"], f"{wanted[r['method']]:.0f}" + ("" if r["ms"] <= wanted[r["method"]] else ": **missed**"), 1000 / r["ms"], r["floorMs"], r["stillMs"], r["samples"] / 1e6,
                 ", ".join(f"{name} {number(round(ms, 1))}" for name, ms in r["stages"].items() if ms >= 0.05)] for r in cloud["rows"]]
        parts.append(f"**{cloud['name']}**\n\n" + table(["", "full quality", "wanted", "frames/s", "moving", "still", "million samples", "of full quality, ms"], rows))
    return "\n\n".join(parts + ([data["said"]] if data["said"] else []))


def measure_papers(bench):
    """methods.py knows the settings; here they are asked for one after another."""
    voronoi = papers_settings.voronoi_rate(bench.tool("bench_surfel_methods"), 2000 if bench.quick else 50000)
    hidden = bench.turn(bench.town(), "pyramid", size=(160, 96) if bench.quick else (1248, 768))
    sizes = papers_settings.PLOT_SIZES[::5] if bench.quick else papers_settings.PLOT_SIZES
    rates = {}
    for size in sizes:
        flags = ["--detail", "1", "--param", f"scale={size}" if size > 0 else "sizePx=1"]
        for method, label, _ in papers_settings.PLOT_METHODS:
            stats = bench.turn(bench.town(), method, size=bench.size if bench.quick else (1920, 955), views=4, flags=flags)
            rates.setdefault(method, []).append([size, 1000 / without(stats, "encode")])
    return {"voronoi": voronoi, "hidden": stage(hidden, "hidden points"), "pyramid": hidden["medianMs"], "rates": rates}


def papers_page(data):
    labels = {method: label for method, label, _ in papers_settings.PLOT_METHODS}
    sizes = [size for size, _ in next(iter(data["rates"].values()))]
    rows = [[f"{size:g}", *(data["rates"][method][i][1] for method in data["rates"])] for i, size in enumerate(sizes)]
    return "\n\n".join([
        table(["setting", "paper", "here"], [
            ["Voronoi rasterization: 50,000 smooth discs, 1024 x 768 (`bench_surfel_methods`)", "10 frames/s on its GPU", f"{number(data['voronoi'])} frames/s"],
            ["hidden point removal, 1248 x 768, the town", "2.1-2.7 ms on a GTX 1080, its predecessor 21-58 ms", f"{number(data['hidden'])} ms"],
            ["all of `pyramid` in that picture, with its JPEG", "", f"{number(data['pyramid'])} ms"]]),
        "Frames/s over the size of points, 1920 x 955, without the JPEG, the town at τ = 1 for all; size 0 is 1 px, 1 closes holes:",
        table(["size", *(labels[method] for method in data["rates"])], rows), "![frames/s over the size of points](PLOTS/point-sizes.svg)"])


def papers_plots(data):
    from .. import plot
    labels = {method: label for method, label, _ in papers_settings.PLOT_METHODS}
    return {"point-sizes.svg": plot.lines("Frames/s over the size of points", "point size, factor on the size that closes holes", "frames/s",
                                          [(labels[method], points) for method, points in data["rates"].items()])}
