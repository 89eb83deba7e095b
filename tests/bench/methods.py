#!/usr/bin/python3
"""All rendering methods: how near to the truth, how steady in motion, how fast; and the settings of their papers.

    tests/bench/methods.py [--scan SCAN.laz] [--bin build/release/bin] [--bench build/bench/bench]
                           [--only table,papers,speed] [--town TOWN.scan] [--scenes sign,cube]
    tests/bench/methods.py --only clips --clouds a.scan,b.scan [--methods sphere] [--backend egl] [--turns 5] [--size 1280x720]
    tests/bench/methods.py --only ratio --before OTHER/BUILD/bin/scancast --clouds a.scan,b.scan

Prints Markdown, ready for docs/performance.md:
  table   method x scene: PSNR and SSIM against the ray-cast truth, holes, stability, milliseconds of each pass
          (compare_methods, which says what the columns are)
  papers  what the papers measured, in their settings, beside their figures; and draws the plot of Fig. 8 in
          Schütz and Wimmer, "High-Quality Point-Based Rendering Using Fast Single-Pass Interpolation", 2015, §V
          (frames/s over point size) as docs/images/point_sizes.svg (--plot)
  speed   frames/s at 1280 x 720 of a turning town of 20 million points, and of a real scan where --scan names one,
          against the marks; a frame is everything from the view to the JPEG
  ratio   each method's time in this build over that in another (--before), on cloud files that both can read: one thread,
          what both draw without being asked left out, least of nine turns each, builds in turn. Below 1 is faster
  clips   each method's processor time with shapes that cut (--clips) over that without, in turn: one turned box around everything; eight
          turned slabs that together keep everything, so that the picture is the same and each sample near one of their
          seven borders is looked at; eight turned boxes of a tenth of the cloud, spread over it, whose insides are taken away

Moving: what the server may go down to while the camera moves, one sample a pixel: first detail (2 px at full
resolution), then resolution, too (640 x 360 with 2 px of that picture), its floor.
Clouds are ingested with surfels, surfels of the real scan face upwards. compare_methods and bench_surfel_methods are
built with: cmake --preset release -B build/bench -DSCANCAST_BENCH=ON
            cmake --build build/bench --target compare_methods bench_surfel_methods
"""
import argparse
import json
import math
import os
import re
import resource
import subprocess
import sys
import tempfile

from sight.camera import camera_flags

SPRITES = ["point", "square", "circle", "paraboloid", "cone", "sphere"]
METHODS = SPRITES + ["hqs", "disc", "ewa", "voronoi", "pyramid"]
# Frames/s wanted on two cores at full quality; moving, all of them 30.
MARKS = {**{name: 30 for name in SPRITES}, "hqs": 20, "disc": 20, "ewa": 12, "voronoi": 12, "pyramid": 12}
MOVING_MARK = 30
OWN_DETAIL = {"hqs": 2, "disc": 2, "ewa": 2, "voronoi": 2}  # the others: 1
FRAMES = 36  # three turns: medians are of views whose blocks are in memory from the first one

# What compares with what: Fig. 8 of that paper has these modes, top to bottom, and sizes 0 to 2.5.
PLOT_METHODS = [("square", "squares", "#4878a8"), ("circle", "circles", "#6a9f58"),
                ("paraboloid", "paraboloids", "#d1615d"), ("hqs", "three-pass splats", "#85629a")]
PLOT_SIZES = [0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2, 2.25, 2.5]


def output_of(command):
    """What it prints; its errors go to the terminal."""
    try:
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    except (OSError, subprocess.CalledProcessError) as problem:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {problem}")


def first_camera(scancast, cloud):
    return json.loads(output_of([scancast, "look", cloud]))["views"][0]["camera"]


def turn(scancast, cloud, method, width=1280, height=720, frames=FRAMES, flags=()):
    """The statistics of three turns, one sample a pixel."""
    return json.loads(output_of([scancast, "render", cloud, "--method", method, "--width", str(width), "--height", str(height),
                                 "--samples", "1", "--repeat", str(frames), "--orbit", str(3 * 360 / frames), "--stats", "json", *flags]))


def stage(stats, *names):
    return sum(s["medianMs"] for s in stats["stages"] if s["name"] in names)


def verdict(reached):
    return "reached" if reached else "**missed**"


def stages_of(stats):
    return ", ".join(f"{s['name']} {s['medianMs']:.1f}" for s in stats["stages"])


def table(bench, scenes):
    print("## Method × scene, against the truth\n")
    print("1280 × 720, unlit; generated scenes, their views averaged. PSNR and SSIM against rays cast through the scene, 4 samples a "
          "pixel. Turned: pixels that change by more than 16 of 255 in an orbit by 0.1° (in brackets: drawn by brute force); "
          "levels: of these, by changes of level alone, worst step. ms: one sample a pixel, without encoding.\n", flush=True)
    command = [os.path.join(bench, "compare_methods")] + (["--scenes", scenes] if scenes else [])
    subprocess.run(command, check=True)
    print()


def voronoi_rate(program, points=50000):
    """Frames/s of the smooth discs."""
    text = output_of([program, "--points", str(points), "--only", "voronoi"])
    found = re.search(r"voronoi, smooth\s+([\d.]+) ms =\s+([\d.]+) frames/s", text)
    if not found:
        sys.exit(f"methods.py: bench_surfel_methods did not tell of voronoi: {text}")
    return float(found.group(2))


def voronoi(bench):
    fps = voronoi_rate(os.path.join(bench, "bench_surfel_methods"))
    print(f"| Voronoi rasterization: 50,000 smooth discs, 1024 × 768 | 10 frames/s | {fps:.1f} frames/s | ≥ 30 frames/s | {verdict(fps >= 30)} |")


def hidden_points(scancast, clouds):
    for name, cloud in clouds:
        stats = turn(scancast, cloud, "pyramid", 1248, 768)
        ms = stage(stats, "hidden points")
        print(f"| hidden point removal, 1248 × 768, {name} | 2.1-2.7 ms (GTX 1080); its predecessor 21-58 ms | {ms:.1f} ms "
              f"| ≤ 25 ms | {verdict(0 < ms <= 25)} |")
        print(f"| all of `pyramid` in this picture | | {stats['medianMs']:.1f} ms: {stages_of(stats)} | | |")


def in_order(rates):
    """Highest first, but for the noise of medians."""
    return all(a >= 0.97 * b for a, b in zip(rates, rates[1:]))


def point_sizes(scancast, name, cloud, plot):
    """Fig. 8 of the paper on paraboloids, on its canvas; the same samples for all modes."""
    rates = {method: [] for method, _, _ in PLOT_METHODS}
    for size in PLOT_SIZES:
        flags = ["--detail", "1", "--param", f"scale={size}" if size > 0 else "sizePx=1"]
        for method in rates:
            stats = turn(scancast, cloud, method, 1920, 955, 12, flags)
            rates[method].append(1000 / (stats["medianMs"] - stage(stats, "encode")))
    print(f"\n### Frames/s over point size (Fig. 8 of the paper on paraboloids)\n\n1920 × 955, {name}, the same samples (τ = 1) for all; size 0 is 1 px, "
          "1 closes holes. The paper's order, top to bottom: squares, circles, paraboloids, three-pass splats.\n")
    print("| size | " + " | ".join(label for _, label, _ in PLOT_METHODS) + " | in the paper's order |")
    print("|---" * (len(PLOT_METHODS) + 2) + "|")
    for i, size in enumerate(PLOT_SIZES):
        row = [rates[method][i] for method in rates]
        print(f"| {size:g} | " + " | ".join(f"{r:.1f}" for r in row) + f" | {'yes' if in_order(row) else 'no'} |")
    with open(plot, "w", encoding="utf-8") as file:
        file.write(chart(rates))
    print(f"\nPlot: {plot}\n", flush=True)


def chart(rates):
    """An SVG of the rates over the sizes."""
    left, top, width, height = 60, 20, 520, 300
    highest = max(max(values) for values in rates.values())
    step = next(s for s in (5, 10, 20, 50, 100, 200, 500, 1000) if highest / s <= 6 or s == 1000)
    limit = step * (int(highest / step) + 1)
    x = lambda size: left + width * size / PLOT_SIZES[-1]
    y = lambda rate: top + height * (1 - rate / limit)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 760 380" font-family="sans-serif" font-size="13">',
           '<rect width="760" height="380" fill="white"/>']
    for rate in range(0, limit + 1, step):
        out.append(f'<path d="M{left} {y(rate):.1f}H{left + width}" stroke="#ddd"/>'
                   f'<text x="{left - 8}" y="{y(rate) + 4:.1f}" text-anchor="end">{rate}</text>')
    for size in PLOT_SIZES[::2]:
        out.append(f'<text x="{x(size):.1f}" y="{top + height + 20}" text-anchor="middle">{size:g}</text>')
    out.append(f'<text x="{left + width / 2}" y="{top + height + 42}" text-anchor="middle">point size, factor on the size that '
               'closes holes</text>')
    out.append(f'<text transform="translate(18 {top + height / 2}) rotate(-90)" text-anchor="middle">frames/s</text>')
    label_y = top + 10
    for method, label, color in PLOT_METHODS:
        points = " ".join(f"{x(s):.1f},{y(r):.1f}" for s, r in zip(PLOT_SIZES, rates[method]))
        out.append(f'<polyline points="{points}" fill="none" stroke="{color}" stroke-width="2.5"/>')
        out.append(f'<path d="M{left + width + 20} {label_y - 4}h24" stroke="{color}" stroke-width="2.5"/>'
                   f'<text x="{left + width + 50}" y="{label_y}">{label}</text>')
        label_y += 22
    return "\n".join(out + ["</svg>"]) + "\n"


def papers(scancast, bench, clouds, plot):
    print("## The papers' own settings\n\n| setting | paper | here | wanted | |\n|---|---|---|---|---|", flush=True)
    voronoi(bench)
    hidden_points(scancast, clouds)
    point_sizes(scancast, *clouds[0], plot)


def speed(scancast, clouds):
    print(f"## Speed\n\nFrames/s, medians over three turns, 1280 × 720, one sample a pixel, view to JPEG, {os.cpu_count()} cores. Full quality: the "
          "method's own τ. Moving: the server goes down to τ = 2 px, then to half the resolution.\n")
    for name, cloud in clouds:
        print(f"### {name}\n\n| method | full quality | mark | | moving, τ = 2 px | moving, 640 × 360, τ = 2 px | mark | | full quality, ms |")
        print("|---|---|---|---|---|---|---|---|---|", flush=True)
        for method in METHODS:
            full = turn(scancast, cloud, method)
            coarse = full if OWN_DETAIL.get(method, 1) >= 2 else turn(scancast, cloud, method, flags=["--detail", "2"])
            floor = turn(scancast, cloud, method, 640, 360, flags=["--detail", "2"])
            rates = [1000 / stats["medianMs"] for stats in (full, coarse, floor)]
            print(f"| `{method}` | {rates[0]:.1f} | {MARKS[method]} | {verdict(rates[0] >= MARKS[method])} | {rates[1]:.1f} | {rates[2]:.1f} "
                  f"| {MOVING_MARK} | {verdict(max(rates[1:]) >= MOVING_MARK)} | {stages_of(full)}; {full['samples'] / 1e6:.1f} M samples |", flush=True)
        print()


def fastest(scancast, cloud, method, flags):
    """ms of the passes of a picture of one sample a pixel, the least of three."""
    stats = turn(scancast, cloud, method, frames=3, flags=["--threads", "1", *flags])
    return sum(stage["medianMs"] for stage in stats["stages"] if stage["name"] not in ("encode", "select", "provide"))


def ratio(scancast, before, clouds):
    print("## Beside another build\n\nTime of this build over the other's: all passes, 1280 × 720, one sample a pixel, one thread; lit as each method is lit, "
          "without occlusion.\n")
    names = [os.path.basename(cloud).removesuffix(".scan") for cloud in clouds]
    print(f"| method | {' | '.join(names)} |\n|---|{'---|' * len(names)}", flush=True)
    cameras = [camera_flags(first_camera(scancast, cloud)) for cloud in clouds]
    for method in METHODS:
        row = []
        for cloud, camera in zip(clouds, cameras):
            here, there = [], []
            for _ in range(9):
                there.append(fastest(before, cloud, method, ["--shading", "auto", *camera]))
                here.append(fastest(scancast, cloud, method, ["--shading", "auto", "--light", "occlusion=0", "--exposure", "0", *camera]))
            row.append(f"{min(here) / min(there):.2f} ({min(here):.1f} ms)")
        print(f"| `{method}` | {' | '.join(row)} |", flush=True)


def shapes_around(low, high):
    """What to say for --clips, by what it is called."""
    (x, y, z), (dx, dy, dz) = [(a + b) / 2 for a, b in zip(low, high)], [b - a for a, b in zip(low, high)]
    whole, yaw = 2 * max(dx, dy, dz), 20
    angle = math.radians(yaw)
    across = max(dx, dy) * 1.4 / 8
    slabs = [f"box:{x + (i - 3.5) * across * math.cos(angle)!r},{y + (i - 3.5) * across * math.sin(angle)!r},{z!r},"
             f"{across * (1.02 if 0 < i < 7 else 4)!r},{whole!r},{whole!r},{yaw}" for i in range(8)]
    holes = [f"-box:{x + ((i % 4) - 1.5) / 4 * dx!r},{y + (i // 4 - 0.5) / 2 * dy!r},{z!r},{dx / 10!r},{dy / 10!r},{dz!r},{5 + 40 * i}"
             for i in range(8)]
    return {"1 box": f"box:{x!r},{y!r},{z!r},{whole!r},{whole!r},{whole!r},{yaw}", "8 slabs": ";".join(slabs), "8 holes": ";".join(holes)}


def frame_time(scancast, cloud, flags, few=3, many=43):
    """Processor time of a frame without its encoding, ms: of `many` frames less that of `few`, which is what starting takes."""
    taken, encode = [], 0
    for frames in (few, many):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        stats = json.loads(output_of([scancast, "render", cloud, "--repeat", str(frames), "--orbit", "1", "--stats", "json", "--threads", "1", *flags]))
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(1000 * (after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime))
        encode = stage(stats, "encode")
    return (taken[1] - taken[0]) / (many - few), encode


def clips(scancast, clouds, methods, backend, turns, size):
    width, height = size.split("x")
    few, many = (3, 43) if backend == "cpu" else (8, 32)  # shaders are compiled in the first ones
    for cloud in clouds:
        look = json.loads(output_of([scancast, "look", cloud]))
        shapes = shapes_around(look["bounds"]["min"], look["bounds"]["max"])
        flags = ["--backend", backend, "--width", width, "--height", height, "--samples", "1", "--shading", "unlit", "--light", "occlusion=0",
                 *camera_flags(look["views"][0]["camera"])]
        print(f"## Cut by shapes: {os.path.basename(cloud)}, {backend}\n\nProcessor time of a frame, selecting included and encoding not; {width} x {height}, "
              f"one sample a pixel, one thread, least of {turns} turns.\n\n| method | not cut | {' | '.join(shapes)} |\n|---|---|{'---|' * len(shapes)}", flush=True)
        for method in methods:
            taken, encode = {name: [] for name in ["", *shapes]}, []
            for _ in range(turns):
                for name, times in taken.items():
                    cut = ["--clips=" + shapes[name]] if name else []
                    ms, encoding = frame_time(scancast, cloud, ["--method", method, *flags, *cut], few, many)
                    times.append(ms)
                    encode.append(encoding)
            plain, *cut = [min(times) - min(encode) for times in taken.values()]
            print(f"| `{method}` | {plain:.1f} ms | {' | '.join(f'{ms / plain:.2f} ({ms:.1f} ms)' for ms in cut)} |", flush=True)
        print()


def prepare(scancast, arguments, folder):
    """Cloud files, with what to call them."""
    clouds = []
    town = arguments.town
    if not town:
        las, town = os.path.join(folder, "town.las"), os.path.join(folder, "town.scan")
        output_of([scancast, "generate", "town", "--points", arguments.points, "-o", las, "--quiet"])
        output_of([scancast, "ingest", las, "-o", town, "--quiet"])
        os.remove(las)
    clouds.append((f"town, {arguments.points} points" if not arguments.town else os.path.basename(town), town))
    if arguments.scan:
        scan = arguments.scan
        if not scan.endswith(".scan"):
            scan = os.path.join(folder, "real.scan")
            output_of([scancast, "ingest", arguments.scan, "-o", scan, "--orient", "up", "--quiet"])
        clouds.append((os.path.basename(arguments.scan), scan))
    else:
        print("No real scan: --scan SCAN.laz names one.\n")
    return clouds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    parser.add_argument("--bin", default=os.path.join(root, "build/release/bin"), help="folder of the scancast program")
    parser.add_argument("--bench", default=os.path.join(root, "build/bench/bench"), help="folder of the benchmarks")
    parser.add_argument("--only", default="table,papers,speed", help="which parts, comma between them")
    parser.add_argument("--scenes", help="of the table; by default all that have views and no mirrors")
    parser.add_argument("--points", default="20M", help="of the town")
    parser.add_argument("--town", help="a cloud file of the town that is there already")
    parser.add_argument("--scan", help="a real scan, or a cloud file of one")
    parser.add_argument("--plot", default=os.path.join(root, "docs/images/point_sizes.svg"), help="where the plot goes")
    parser.add_argument("--before", help="another build's program, for ratio")
    parser.add_argument("--clouds", help="cloud files for ratio and clips, comma between them")
    parser.add_argument("--backend", default="cpu", help="of clips: cpu, egl or osmesa")
    parser.add_argument("--methods", default=",".join(METHODS), help="of clips: which")
    parser.add_argument("--turns", type=int, default=5, help="of clips: the least of so many is told")
    parser.add_argument("--size", default="1280x720", help="of clips: width and height of the pictures")
    parser.add_argument("--folder", help="where to work; by default a temporary folder")
    arguments = parser.parse_args()
    scancast, parts = os.path.join(arguments.bin, "scancast"), arguments.only.split(",")
    with tempfile.TemporaryDirectory(dir=arguments.folder) as folder:
        if "table" in parts:
            table(arguments.bench, arguments.scenes)
        if "ratio" in parts:
            ratio(scancast, arguments.before, arguments.clouds.split(","))
        if "clips" in parts:
            clips(scancast, arguments.clouds.split(","), arguments.methods.split(","), arguments.backend, arguments.turns, arguments.size)
        if "papers" in parts or "speed" in parts:
            clouds = prepare(scancast, arguments, folder)
            if "papers" in parts:
                papers(scancast, arguments.bench, clouds, arguments.plot)
            if "speed" in parts:
                speed(scancast, clouds)


if __name__ == "__main__":
    main()
