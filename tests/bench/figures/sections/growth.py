"""How time grows: with points, pixels, τ, threads and clients; a table and a plot of each."""
import json
import os
import time

from .. import plot
from ..bench import Failed, room, run, without
from ..words import number, power, short, table

WITHOUT_SURFELS = ("point", "paraboloid", "hqs", "pyramid")
DRAWN = ("point", "paraboloid", "hqs", "disc", "ewa", "voronoi", "pyramid")
BRUTE_FORCE_BYTES = 24  # of memory a point, at most


def curves(data, name_of=str):
    """A table of {series: [[x, y], …]}, whose xs may differ."""
    xs = sorted({x for points in data.values() for x, _ in points})
    found = {name: dict(map(tuple, points)) for name, points in data.items()}
    return table(["", *(f"`{name}`" if name in DRAWN else name for name in data)], [[name_of(x), *(found[name].get(x) for name in data)] for x in xs])


# ---- points

def memory():
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def measure_points(bench):
    lines, ingest, said = {}, [], []
    every = "point, every point"
    sizes = [10**e for e in (range(3, 6) if bench.quick else range(5, 10))]
    for points in sizes:
        if points > bench.up_to:
            said.append(f"{power(points)} points were not asked for (`--points-up-to {short(points)}`).")
            continue
        if lacking := room(points)(bench):
            said.append(f"{power(points)} points: {lacking}.")
            continue
        begun = time.monotonic()
        cloud = bench.town(points, surfels=False, piped=True)
        ingest.append([points, time.monotonic() - begun, os.path.getsize(cloud)])
        for method in bench.methods(*WITHOUT_SURFELS):
            stats = bench.turn(cloud, method)
            lines.setdefault(method, []).append([points, without(stats, "encode")])
        if points * BRUTE_FORCE_BYTES < memory() * 0.6:
            try:
                stats = bench.turn(cloud, "point", views=2, flags=["--brute-force"])
                lines.setdefault(every, []).append([points, without(stats, "encode")])
            except Failed as problem:
                said.append(f"{power(points)} points without a hierarchy: {problem}.")
        else:
            said.append(f"{power(points)} points without a hierarchy do not fit into this machine's memory ({memory() / 1e9:.0f} GB).")
        os.remove(cloud)
    if not lines:
        raise Failed(" ".join(said))
    return {"lines": lines, "ingest": ingest, "said": said, "size": bench.size}


def points_page(data):
    width, height = data["size"]
    rows = [[power(points), seconds, f"{points / seconds / 1e6:.2f} M points/s", f"{size / points:.1f}"] for points, seconds, size in data["ingest"]]
    return "\n\n".join([
        f"The town, {width} x {height}, from the view to pixels in memory, ms, medians of an orbit at each method's own τ; *every point*: `--brute-force`, without a "
        "hierarchy.", curves(data["lines"], power), "![time of a frame over the points of the town](PLOTS/points.svg)",
        "Making these clouds, `generate | ingest --no-surfels`, the generator beside it; and what they are on disk:",
        table(["points", "s", "", "bytes a point"], rows), *data["said"]])


def points_plots(data):
    sizes = sorted({x for points in data["lines"].values() for x, _ in points})
    return {"points.svg": plot.lines("Time of a frame over the points of the town", "points", "ms a frame", list(data["lines"].items()), True, True, sizes, power)}


def town(data):
    return f"The town of {data['points'] / 1e6:g} million points"


# ---- pixels, τ, threads: one cloud, one flag

def one_by_one(bench, values, flags_of, size_of=lambda value: None, methods=DRAWN, **more):
    cloud, lines = bench.town(), {}
    for value in values:
        for method in bench.methods(*methods):
            stats = bench.turn(cloud, method, size=size_of(value), flags=flags_of(value), **more)
            lines.setdefault(method, []).append([value if not isinstance(value, tuple) else value[0] * value[1], without(stats, "encode")])
    return lines


PICTURES = [(320, 180), (640, 360), (960, 540), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160)]


def measure_pixels(bench):
    return {"points": bench.points, "lines": one_by_one(bench, PICTURES[:2] if bench.quick else PICTURES, lambda _: [], lambda size: size)}


def of_pixels(count):
    return next((f"{w} x {h}" for w, h in PICTURES if w * h == count), f"{count:,}")


def pixels_page(data):
    return "\n\n".join([f"{town(data)}, from the view to pixels in memory, ms, each method at its own τ.", curves(data["lines"], of_pixels),
                        "![time of a frame over its pixels](PLOTS/pixels.svg)"])


def pixels_plots(data):
    sizes = sorted({x for points in data["lines"].values() for x, _ in points})
    return {"pixels.svg": plot.lines("Time of a frame over its pixels", "pixels", "ms a frame", list(data["lines"].items()), True, True, sizes,
                                     lambda count: f"{next((h for w, h in PICTURES if w * h == count), count)}p")}


DETAILS = [0.5, 0.7, 1, 1.4, 2, 2.8, 4, 8]


def measure_tau(bench):
    return {"points": bench.points, "size": bench.size, "lines": one_by_one(bench, DETAILS[::4] if bench.quick else DETAILS, lambda tau: ["--detail", str(tau)])}


def tau_page(data):
    width, height = data["size"]
    return "\n\n".join([f"{town(data)}, {width} x {height}, from the view to pixels in memory, ms. τ is the distance of neighbouring samples on the screen "
                        "down to which the cloud is refined: `--detail`.", curves(data["lines"], lambda x: f"{x:g} px"), "![time of a frame over τ](PLOTS/tau.svg)"])


def tau_plots(data):
    sizes = sorted({x for points in data["lines"].values() for x, _ in points})
    return {"tau.svg": plot.lines("Time of a frame over τ", "τ, px between neighbouring samples", "ms a frame", list(data["lines"].items()), True, True, sizes,
                                  lambda x: f"{x:g}")}


def thread_counts():
    cores = len(os.sched_getaffinity(0))
    return sorted({count for count in (1, 2, 4, 8, 16, 32, 64, 128) if count < cores} | {cores})


def measure_threads(bench):
    return {"points": bench.points, "size": bench.size, "lines": one_by_one(bench, thread_counts(), lambda threads: ["--threads", str(threads)])}


def threads_page(data):
    width, height = data["size"]
    least = lambda points: min(points)[1]
    shares = [[f"`{name}`", min(points)[1], max(points)[1], f"{least(points) / max(points)[1]:.2f}"] for name, points in data["lines"].items()]
    most = max(x for points in data["lines"].values() for x, _ in points)
    return "\n\n".join([f"{town(data)}, {width} x {height}, from the view to pixels in memory, ms.",
                        table(["", "1 thread", f"{most} threads", "times as fast"], shares), "![frames/s over threads](PLOTS/threads.svg)"])


def threads_plots(data):
    counts = sorted({x for points in data["lines"].values() for x, _ in points})
    rates = [(name, [(x, 1000 / ms) for x, ms in points]) for name, points in data["lines"].items()]
    return {"threads.svg": plot.lines("Frames/s over threads", "threads", "frames/s", rates, ticks_x=counts)}


# ---- clients

def measure_clients(bench):
    import serving
    counts, seconds, rows = ([1, 2], 1, []) if bench.quick else ([1, 2, 4, 8, 16, 32], 8, [])
    serving.allow_many_files()
    with open(bench.path("clients.log"), "w", encoding="utf-8") as log:
        server = serving.Server(bench.scancast, bench.town(), 100, log)
        try:
            command = [bench.client, "bench", server.url, "--json", "--timeout", "180", "--width", str(bench.size[0]), "--height", str(bench.size[1])]
            run([*command, "--moving", "1", "--seconds", str(seconds)])  # what the walk shows is read once, for everybody
            for count in counts:
                group = json.loads(run([*command, "--moving", str(count), "--seconds", str(seconds)]))["groups"][0]
                if group["failed"] or not group["latencyMs"]:
                    raise Failed(f"{count} clients: {'; '.join(group['errors']) or 'no frame came'}")
                rate, wait = group["framesPerSecond"], group["latencyMs"]
                rows.append([count, rate["p50"], rate["min"], wait["p50"], wait["p99"], group["resolution"]["p50"]])
        finally:
            server.stop()
    return {"points": bench.points, "rows": rows, "size": bench.size}


def clients_page(data):
    width, height = data["size"]
    return "\n\n".join([
        f"{town(data)}, {width} x {height}, clients on the server's own cores, each sends 60 views a second and asks for 30 frames: moving quality, which "
        "falls to half of the resolution where it must.",
        table(["clients", "frames/s of each, median", "of the slowest", "all together", "view to its frame, ms, median", "99 %", "resolution"],
              [[count, rate, least, count * rate, wait, worst, f"{number(resolution)} of full"] for count, rate, least, wait, worst, resolution in data["rows"]]),
        "![frames/s over clients](PLOTS/clients.svg)"])


def clients_plots(data):
    rows = data["rows"]
    lines = [("each, median", [(r[0], r[1]) for r in rows]), ("the slowest", [(r[0], r[2]) for r in rows]), ("all together", [(r[0], r[0] * r[1]) for r in rows])]
    return {"clients.svg": plot.lines("Frames/s over clients that move", "clients", "frames/s", lines, log_x=True, ticks_x=[r[0] for r in rows])}
