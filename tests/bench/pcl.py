#!/usr/bin/python3
"""The Point Cloud Library's normals and radii beside ours: agreement, truth, speed, memory, determinism, installation.

    tests/bench/pcl.py [--bench build/release/bench] [--data ../shared/data] [--only agreement,truth,speed,bytes,size]

Prints the tables of the decision page on PCL (docs/decisions), Markdown. Needs libpcl-dev, and the program
    cmake --preset release -DSCANCAST_BENCH=ON && cmake --build build/release --target bench_pcl scancast-import-pcl scancast-import-laz
k is 10 for both, points are distinct. Ours always finds normals, radii, both axes and outliers. `NormalEstimationOMP` is
PCL's own class, which gives normals (and a curvature); "one query" is a loop of PCL's kd-tree search and
pcl::computePointNormal that keeps the radius, too. Memory is what the process's largest resident set grows by, results
included, the points not. Each row is measured in turn, --rounds times; the fastest counts.
Real scans that are not there are left out, and named.
"""
import argparse
import glob
import json
import os
import re
import subprocess
import sys

REAL = ["laz/ahn3-delft.laz", "las/autzen_trim.las", "laz/strand-statue-1m.laz", "ply/guanyin-statue.ply", "pcd/office1.pcd"]
MADE = ["torus", "statue", "town", "rows"]
WHO = {"ours": "ours: normal, radius, axes, outlier", "pcl": "PCL, `NormalEstimationOMP`: normal", "pcl-radii": "PCL, one query: normal, radius"}
BASE = ["libc6", "libstdc++6", "libgcc-s1"]


class Bench:
    """The program, and what it is asked."""

    def __init__(self, folder, data, points):
        self.program, self.data, self.points = os.path.join(folder, "bench_pcl"), data, points

    def ask(self, *words, **environment):
        done = subprocess.run([self.program, *words, "--points", str(self.points)], env={**os.environ, **environment},
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"pcl.py: {self.program} {' '.join(words)}: {done.stderr.strip() or done.returncode}")
        return json.loads(done.stdout)

    def clouds(self, real=tuple(REAL), made=tuple(MADE)):
        """Name and argument."""
        for name in real:
            path = os.path.join(self.data, name)
            if os.path.exists(path):
                yield name, path
            else:
                print(f"pcl.py: SKIPPED {name}: it is not in {self.data}", file=sys.stderr)
        yield from ((f"generated {name}", name) for name in made)


def percent(share):
    return f"{100 * share:.2f} %"


def agreement(bench):
    print("### Agreement\n\n| cloud | points | scan lines | ties | normals of the rest: median, 99 % | radii of the rest: 99 % "
          "| within 1° of all |\n|---|---|---|---|---|---|---|", flush=True)
    for name, cloud in bench.clouds():
        found = bench.ask("compare", cloud)
        angle, radius = found["angle"], found["radius"]
        rest = f"{angle['median']:.0e}°, {angle['p99']:.0e}° | {radius['p99']:.0e}" if angle else "none is left | none is left"
        print(f"| {name} | {found['points']:,} | {percent(found['lines'])} | {percent(found['ties'])} | {rest} "
              f"| {percent(found['withinOneDegree'])} |", flush=True)


def truth(bench):
    print("\n### Truth: angle to the true normal, median and 90 %\n\n| cloud | ours | PCL, k = 10 | PCL, k = 80 |\n|---|---|---|---|", flush=True)
    for name, cloud in bench.clouds(real=()):
        ten, eighty = bench.ask("compare", cloud)["truth"], bench.ask("compare", cloud, "--pcl-neighbours", "80")["truth"]
        row = [f"{found['all']['median']:.2f}°, {found['all']['p90']:.2f}°" for found in (ten["ours"], ten["pcl"], eighty["pcl"])]
        print(f"| {name} | {' | '.join(row)} |", flush=True)


def speed(bench, rounds):
    print("\n### Speed and memory\n\n| cloud | | 1 thread | 2 threads | processor time a point | memory a point |\n|---|---|---|---|---|---|", flush=True)
    rows = [(name, cloud, []) for name, cloud in bench.clouds(real=REAL[:1], made=("town",))]
    rows.append(("generated town, shuffled", "town", ["--shuffled"]))
    for name, cloud, flags in rows:
        asked = [(who, told, []) for who, told in WHO.items()]
        asked.append(("pcl-radii", "PCL, one query, k = 80", ["--pcl-neighbours", "80"]))
        runs = {told: {"1": [], "2": []} for _, told, _ in asked}
        for _ in range(rounds):
            for who, told, more in asked:
                for threads in ("1", "2"):
                    runs[told][threads].append(bench.ask("estimate", who, cloud, "--threads", threads, *flags, *more))
        for told, found in runs.items():
            points = found["1"][0]["points"]
            rates = [points / min(run["seconds"] for run in found[threads]) / 1e6 for threads in ("1", "2")]
            work = min(run["processorSeconds"] for run in found["1"]) / points * 1e9
            memory = max(run["peakBytes"] for run in found["2"]) / points
            print(f"| {name} | {told} | {rates[0]:.2f} M/s | {rates[1]:.2f} M/s | {work:.0f} ns | {memory:.0f} bytes |", flush=True)


def same_bytes(bench):
    print("\n### Determinism\n\n| cloud | | 1, 2, 4 threads | twice | points shuffled | every SIMD level |\n|---|---|---|---|---|---|", flush=True)
    for name, cloud in bench.clouds(real=[REAL[0], REAL[-1]], made=("town",)):
        changed = bench.ask("compare", cloud)["reordered"]
        for who, told in (("ours", "ours"), ("pcl-radii", "PCL")):
            digest = lambda *words, **environment: bench.ask("estimate", who, cloud, *words, **environment)["digest"]
            first = digest("--threads", "1")
            verdict = lambda *others: "the same bytes" if set(others) == {first} else "**other bytes**"
            shuffled = changed["ours" if who == "ours" else "pcl"]
            told_shuffled = "the same bytes" if shuffled["different"] == 0 else (
                f"**{percent(shuffled['different'])} other bytes, {percent(shuffled['beyondOneDegree'])} by more than 1°**")
            levels = verdict(*(digest(SCANCAST_SIMD=level) for level in ("v2", "v3", "v4"))) if who == "ours" else "one, the package's"
            print(f"| {name} | {told} | {verdict(digest('--threads', '2'), digest('--threads', '4'))} | {verdict(digest('--threads', '1'))} "
                  f"| {told_shuffled} | {levels} |", flush=True)


def packages():
    """Installed size in KiB and dependencies, by name, of what is installed here."""
    listed = subprocess.run(["dpkg-query", "-W", "-f", "${Package}\t${Installed-Size}\t${Depends},${Pre-Depends}\n"],
                            stdout=subprocess.PIPE, text=True, check=True).stdout
    fields = (line.split("\t") for line in listed.splitlines())
    return {name: (int(size or 0), depends) for name, size, depends in fields}


def closure(installed, names):
    """Packages that these need, themselves included; of alternatives, the first that is here."""
    found, todo = set(), list(names)
    while todo:
        name = todo.pop()
        if name in found or name not in installed:
            continue
        found.add(name)
        for alternatives in installed[name][1].split(","):
            named = (re.match(r"\s*([a-z0-9.+-]+)", one) for one in alternatives.split("|"))
            todo += [match[1] for match in named if match and match[1] in installed][:1]
    return found


def libraries(path):
    """Name and size of the shared libraries that a file loads, itself included."""
    found = re.findall(r"=> (/\S+)", subprocess.run(["ldd", path], stdout=subprocess.PIPE, text=True, check=True).stdout)
    return {os.path.realpath(one): os.path.getsize(one) for one in [path, *found]}


def lines_of_ours(root):
    files = glob.glob(os.path.join(root, "renderer/cloud/surfels/**/*.?pp"), recursive=True)
    count = 0
    for path in files:
        with open(path, encoding="utf-8") as file:
            count += len(file.readlines())
    return count


def size(root):
    installed = packages()
    version = next((name.removeprefix("libpcl-common") for name in installed if re.fullmatch(r"libpcl-common[\d.]+", name)), None)
    if version is None:
        return print("\nNo package of PCL is installed: no sizes.")
    base = closure(installed, BASE)
    rows = {"ours: oneTBB": ["libtbb12"],
            "PCL's estimation": [f"libpcl-features{version}"],
            "PCL's readers, which `scancast-import-pcl` needs": [f"libpcl-io{version}"],
            "both of PCL": [f"libpcl-features{version}", f"libpcl-io{version}"],
            "to build: `libpcl-dev`": ["libpcl-dev"]}
    print(f"\n### Size: Debian packages beyond those of the C++ runtime (PCL {version}), with all they need\n\n| | packages | installed |\n|---|---|---|")
    for told, names in rows.items():
        needed = closure(installed, names) - base
        print(f"| {told} | {len(needed)} | {sum(installed[name][0] for name in needed) / 1024:.0f} MiB |")
    print("\n| loaded by | shared libraries | of PCL | their size |\n|---|---|---|---|")
    for part in ("features", "io"):
        path = next(iter(glob.glob(f"/usr/lib/*/libpcl_{part}.so.{version}")), None)
        if path:
            loaded = libraries(path)
            of_pcl = sum("libpcl_" in name for name in loaded)
            print(f"| `libpcl_{part}` | {len(loaded)} | {of_pcl} | {sum(loaded.values()) / 2**20:.0f} MiB |")
    print(f"\nOurs is {lines_of_ours(root):,} lines to look after.")


def main():
    root = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bench", default=os.path.join(root, "build/release/bench"), help="folder of bench_pcl")
    parser.add_argument("--data", default=os.path.join(root, "../shared/data"), help="folder of the real scans")
    parser.add_argument("--points", type=int, default=1_000_000, help="of the generated clouds")
    parser.add_argument("--rounds", type=int, default=3, help="of the speeds")
    parser.add_argument("--only", default="agreement,truth,speed,bytes,size", help="which tables, comma between them")
    arguments = parser.parse_args()
    bench = Bench(arguments.bench, arguments.data, arguments.points)
    tables = {"agreement": lambda: agreement(bench), "truth": lambda: truth(bench), "speed": lambda: speed(bench, arguments.rounds),
              "bytes": lambda: same_bytes(bench), "size": lambda: size(root)}
    for name in arguments.only.split(","):
        if name not in tables:
            sys.exit(f"pcl.py: no table {name}; there are {', '.join(tables)}")
        tables[name]()


if __name__ == "__main__":
    main()
