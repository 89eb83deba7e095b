#!/usr/bin/python3
"""How long a picture by many ranks takes (scancast-ranks serve): a model, its inputs measured here, up to 64 ranks and 100 Gbit/s.

    tests/bench/ranks/model.py --measure --cloud town.scan --bin build/release/bin [--threads 1] -o passes.json
    tests/bench/ranks/model.py passes.json [--methods paraboloid,ewa] [--weak]       # Markdown, ready for docs/scaling.md
    tests/bench/ranks/model.py passes.json --check --cloud town.scan --bin build/release/bin [--ranks 1,2,4]

What it says a picture is (docs/decisions/025-pictures-by-ranks.md):
  share    each splat pass's time, divided by the ranks; the one with the most nodes is waited for. Nodes are whose NodeShare says
           (renderer/residency/node_share.hpp); how unevenly that shares the nodes of a view is reckoned
  copy     each rank clears planes of the whole screen and looks where it has anything, packs what others' rows get, and merges what its own
           get; where everybody needs keys, it unpacks all of them. Bytes over --copy-rate
  agree    what a rank has in others' rows of the screen over its link - a share of what is not empty, less than 1/N of it only where
           nodes hide none of each other (--overlap) -; keys that everybody needs, from their owners; pixels, to the rank that shows; a bit for each 16
           pixels with each. Keys are 8 bytes a pixel, sums 4 for each of 4 planes, 7 with normals, colours of samples 4, 8 with normals
  screen   resolving and lighting, divided by the ranks
  alone    selection, JPEG, and the pyramid's passes, by the rank that shows
--weak: N times as many samples by N ranks, in the same picture.
--check asks `scancast-ranks render`, on this machine, for the same pictures and prints both. There the link is memory (--shared-rate), and ranks
share its cores with each other and whatever else runs: how long a picture takes so is measured in turn, by one and by as many `scancast render`
at once, which have nothing to agree on.
"""
import argparse
import functools
import json
import math
import os
import random
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import png_file

METHODS = ["point", "square", "circle", "paraboloid", "cone", "sphere", "hqs", "disc", "ewa", "voronoi", "pyramid"]
DIVIDED = ("resolve", "phong", "eyedome", "occlusion", "shadow", "smooth")  # of their own rows each
WHOLE = ("hidden points", "pull-push", "normals", "visibility")  # with one of these, nothing is divided
SPLATS = ("silhouette", "nearest", "cell", "sum")  # the passes that every rank does with its share
GBIT = 125e6  # bytes a second
LINKS = (10, 25, 100)
RANKS = (1, 2, 4, 8, 16, 32, 64)
# Of each splat pass and of colours by ordinals: bytes a pixel that go to whose rows they are, and whether everybody gets the result.
AGREED = {"hqs": [(8, True), (4 * 4, False)], "disc": [(8, True), (2 * 4, False)], "ewa": [(8, True), (7 * 4, False)],
          "voronoi": [(8, True), (8, True), (7 * 4, False)]}
NODE_SAMPLES = 12000  # of a node on average; what a picture's samples are divided by


def owner(node, ranks):
    """NodeShare::has(), for one node."""
    return (node + node // 64) % ranks


@functools.cache
def fullest(nodes, ranks):
    """The largest share of the work over the mean one, of so many nodes: of those side by side a view shows four in five, and each is some part of the
    most work that one makes. (Held against cuts of two clouds with 47 to 428 nodes, by 2 to 16 ranks: their mean over six views is within 0.1 of
    it mostly, and up to half more of what is above 1 where 8 ranks or more share 47 nodes.)"""
    if ranks == 1 or nodes == 0:
        return 1.0
    found = []
    for seed in range(24):
        chance = random.Random(seed)
        work, node = [0.0] * ranks, chance.randrange(1000)
        for _ in range(nodes):
            node += 1
            while chance.random() > 0.8:
                node += 1
            work[owner(node, ranks)] += chance.random()
        found.append(max(work) * ranks / sum(work))
    return sum(found) / len(found)


def has(ranks, overlap):
    """Of what is occupied, how much one rank has something in, where so many nodes have."""
    return 1 - (1 - 1 / ranks) ** overlap


def messages(passes, ranks, overlap):
    """Of each exchange the bytes that one rank sends, and gets at most; and what everybody packs and unpacks on the way."""
    pixels = passes["width"] * passes["height"]
    occupied, others = pixels * passes["filled"], (ranks - 1) / ranks
    marks = passes["height"] * math.ceil(passes["width"] / 1024) * 8
    for a_pixel, everybody in AGREED.get(passes["method"], [(8, False)]):
        own = occupied * a_pixel * has(ranks, overlap) * others + marks * others
        yield own, own, 3 * own
        if everybody:
            yield occupied * 8 * others + marks * others, occupied * 8 * others + marks * others, occupied * 8
    # Pixels, or, where passes look at the whole screen, depths with them.
    finished = occupied * (4 if divided(passes) else 8)
    yield 0, finished * others + marks * others, finished


def divided(passes):
    return not any(name in WHOLE for name, _ in passes["stages"])


def picture(passes, ranks, rate, latency, copy_rate=6e9, weak=False, slower=1.0, slower_alone=1.0, overlap=2.2):
    """Milliseconds by what they are spent on. `passes` is one method's entry of the measured file. What all ranks do at the same time takes
    `slower` times as long as it says, where they share cores, and what one does alone `slower_alone` times."""
    nodes = max(1, round(passes["samples"] / NODE_SAMPLES)) * (ranks if weak else 1)
    shared = [name for name in DIVIDED if divided(passes) and ranks > 1]
    splats = sum(ms for name, ms in passes["stages"] if name in SPLATS)
    screen = sum(ms for name, ms in passes["stages"] if name in shared)
    alone = sum(ms for name, ms in passes["stages"] if name not in (*SPLATS, *shared))
    found = {"share": splats / (1 if weak else ranks) * fullest(nodes, ranks) * slower, "copy": 0.0, "agree": 0.0,
             "screen": screen / ranks * slower, "alone": alone * slower_alone}
    if ranks > 1:
        pixels = passes["width"] * passes["height"]
        for a_pixel, _ in AGREED.get(passes["method"], [(8, False)]):
            # Cleared, and looked at.
            found["copy"] += 1000 * 2 * pixels * a_pixel / copy_rate * slower
            found["agree"] += 1000 * 2 * math.ceil(math.log2(ranks)) * latency
        for sent, got, copied in messages(passes, ranks, overlap):
            found["copy"] += 1000 * copied / copy_rate * slower
            found["agree"] += 1000 * (max(sent, got) / rate + 2 * latency)
    return found


def given(passes, ranks, overlap):
    """Bytes that rank 0 sends of a picture."""
    return sum(sent for sent, _, _ in messages(passes, ranks, overlap)) if ranks > 1 else 0


def total(*arguments, **more):
    return sum(picture(*arguments, **more).values())


# What is measured.

def output_of(command, **more):
    try:
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True, **more).stdout
    except (OSError, subprocess.CalledProcessError) as problem:
        sys.exit(f"{os.path.basename(sys.argv[0])}: {problem}")


def rendered(command, method, size, more=()):
    return json.loads(output_of([*command, "--width", str(size[0]), "--height", str(size[1]), "--method", method, "--samples", "1", "--stats",
                                 "json", *more]).strip().splitlines()[-1])


def measured(arguments):
    render = [*arguments.before.split(), os.path.join(arguments.bin, "scancast"), "render", arguments.cloud, "--threads", str(arguments.threads)]
    size, methods = (arguments.width, arguments.height), []
    with tempfile.TemporaryDirectory() as folder:
        drawn = os.path.join(folder, "picture.png")
        for method in arguments.methods:
            rendered(render, method, size, ("--background", "transparent", "-o", drawn))
            alpha = png_file.read(drawn).channel(3)
            runs = [rendered(render, method, size, ("--repeat", str(arguments.repeat), "-o", os.path.join(folder, "picture.jpg")))
                    for _ in range(arguments.rounds)]
            stats = min(runs, key=lambda run: run["medianMs"])
            methods.append({"method": method, "width": size[0], "height": size[1], "samples": stats["samples"],
                            "filled": round(1 - alpha.count(0) / len(alpha), 4),
                            "stages": [[stage["name"], round(stage["medianMs"], 3)] for stage in stats["stages"]]})
    return {"cloud": os.path.basename(arguments.cloud), "threads": arguments.threads, "methods": methods}


# What is printed.

def table(data, arguments):
    latency = arguments.latency / 1e6
    chosen = [passes for passes in data["methods"] if passes["method"] in arguments.methods]
    for link in arguments.links:
        what = "N times the samples by N ranks" if arguments.weak else "the same picture by N ranks"
        print(f"\n{link} Gbit/s, {what}, ms a picture" + (" (and what of it is agreeing)" if arguments.agreeing else "") + ":\n")
        print("| | " + " | ".join(map(str, arguments.counts)) + " |\n|" + "---|" * (1 + len(arguments.counts)))
        for passes in chosen:
            cells = []
            for ranks in arguments.counts:
                found = picture(passes, ranks, link * GBIT, latency, arguments.copy_rate, arguments.weak, overlap=arguments.overlap)
                cells.append(f"{sum(found.values()):.1f}" + (f" ({found['agree']:.1f})" if arguments.agreeing and ranks > 1 else ""))
            print(f"| `{passes['method']}` | " + " | ".join(cells) + " |")


def crowded(arguments, passes, threads, count):
    """Milliseconds that each of so many takes that draw at the same time here, now, and have nothing to agree on."""
    def started(folder, number):
        return subprocess.Popen([*arguments.before.split(), os.path.join(arguments.bin, "scancast"), "render", arguments.cloud, "--threads", str(threads), "--method", passes["method"], "--width",
                                 str(passes["width"]), "--height", str(passes["height"]), "--samples", "1", "--stats", "json", "--repeat",
                                 str(arguments.repeat), "-o", os.path.join(folder, f"{number}.jpg")], stdout=subprocess.PIPE, text=True)

    with tempfile.TemporaryDirectory() as folder:
        running = [started(folder, number) for number in range(count)]
        return sum(json.loads(process.communicate()[0])["medianMs"] for process in running) / count


def check(data, arguments):
    print("| | ranks | model, ms | measured, ms | model over measured | sent by rank 0: model, MB | measured, MB |\n|---|---|---|---|---|---|---|")
    off = {}
    for passes in data["methods"]:
        if passes["method"] not in arguments.methods:
            continue
        encode = sum(ms for name, ms in passes["stages"] if name == "encode")
        stored = sum(ms for _, ms in passes["stages"])
        for ranks in arguments.counts:
            command = [*arguments.before.split(), *arguments.mpirun.split(), "-n", str(ranks), os.path.join(arguments.bin, "scancast-ranks"), "render", arguments.cloud, "--threads",
                       str(data["threads"])]
            rounds = []
            for _ in range(arguments.rounds):  # in turn: what this machine does in an hour is not what ranks cost
                alone, slower = crowded(arguments, passes, data["threads"], 1) / stored, crowded(arguments, passes, data["threads"], ranks) / stored
                with tempfile.TemporaryDirectory() as folder:
                    stats = rendered(command, passes["method"], (passes["width"], passes["height"]),
                                     ("--repeat", str(arguments.repeat), "-o", os.path.join(folder, "picture.jpg")))
                model = total(passes, ranks, arguments.shared_rate, arguments.latency / 1e6, arguments.copy_rate, slower=slower, slower_alone=alone,
                              overlap=arguments.overlap)
                rounds.append((model / (stats["medianMs"] + encode * alone), model, stats["medianMs"] + encode * alone))
            ratio, model, real = sorted(rounds)[len(rounds) // 2]
            off.setdefault(ranks, []).append(ratio)
            print(f"| `{passes['method']}` | {ranks} | {model:.0f} | {real:.0f} | {ratio:.2f} | {given(passes, ranks, arguments.overlap) / 1e6:.2f} | "
                  f"{stats['bytesSentPerFrame'] / 1e6:.2f} |", flush=True)
    for ranks, ratios in off.items():
        ratios.sort()
        print(f"\n{ranks} ranks: model over measured: median {ratios[len(ratios) // 2]:.2f}, from {ratios[0]:.2f} to {ratios[-1]:.2f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("passes", nargs="?", help="what --measure wrote")
    parser.add_argument("--measure", action="store_true")
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--weak", action="store_true")
    parser.add_argument("--agreeing", action="store_true", help="print what of it the link takes, too")
    parser.add_argument("--cloud", help="a cloud file")
    parser.add_argument("--bin", default="build/release/bin", help="folder of the programs")
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=720)
    parser.add_argument("--threads", type=int, default=1, help="of each rank")
    parser.add_argument("--repeat", type=int, default=9, help="pictures of a run, whose median counts")
    parser.add_argument("--rounds", type=int, default=5, help="runs, of which the least counts: others use this machine, too")
    parser.add_argument("--counts", "--ranks", default=",".join(map(str, RANKS)))
    parser.add_argument("--links", default=",".join(map(str, LINKS)), help="Gbit/s")
    parser.add_argument("--latency", type=float, default=20, help="microseconds, one way")
    parser.add_argument("--copy-rate", type=float, default=6e9, help="bytes a second that a rank gathers, packs and unpacks")
    parser.add_argument("--overlap", type=float, default=2.2, help="nodes that have something in the same 16 pixels, on average")
    parser.add_argument("--shared-rate", type=float, default=4e9, help="bytes a second between ranks of one machine")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none")
    parser.add_argument("--before", default="", help="a command that starts the others, such as `chrt -r 5`: others wait meanwhile")
    parser.add_argument("-o", "--output")
    arguments = parser.parse_args()
    arguments.methods = arguments.methods.split(",")
    arguments.counts = [int(count) for count in arguments.counts.split(",")]
    arguments.links = [float(link) if "." in link else int(link) for link in arguments.links.split(",")]
    if (arguments.measure or arguments.check) and not arguments.cloud:
        parser.error("--measure and --check need --cloud")
    if not arguments.measure and not arguments.passes:
        parser.error("what --measure wrote is needed")
    if arguments.measure:
        text = json.dumps(measured(arguments), indent=1)
        if arguments.output:
            with open(arguments.output, "w", encoding="utf-8") as file:
                file.write(text + "\n")
        else:
            print(text)
        return
    with open(arguments.passes, encoding="utf-8") as file:
        data = json.load(file)
    (check if arguments.check else table)(data, arguments)


if __name__ == "__main__":
    main()
