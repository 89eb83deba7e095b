"""This build beside another, in turn: every method, stills, brute force, ingest. The gate."""
import os
import time

from .. import gate, machine
from ..bench import camera, run, stage, without
from ..words import number, table

STILLS = ("paraboloid", "hqs", "disc", "ewa", "voronoi", "pyramid")


def old_build(bench):
    """A need."""
    if not bench.given.before:
        return "no other build was named: `--before OTHER/BUILD/bin/scancast`"
    return None if os.access(bench.given.before, os.X_OK) else f"{bench.given.before} is no program"


def plain_flags(scancast):
    """What turns off that a build draws without being asked, as far as it knows the words: the rest is asked of both in the same words."""
    words = run([scancast, "render", "--help"])
    found = []
    for flag, value in (("--light", "occlusion=0"), ("--exposure", "0"), ("--mirrors", "false")):
        if f"  {flag} " in words:
            found += [flag, value]
    return found


def cloud_of_both(bench):
    """A cloud file that the old build wrote, where this one can read it: both draw the same samples."""
    old, las = bench.given.before, bench.town_las()
    name = bench.path("before.scan")
    if not os.path.exists(name):
        run([old, "ingest", las, "-o", name, "--force", "--quiet"])
    return name


def time_of(bench, command):
    begun = time.monotonic()
    bench.able(command)
    return time.monotonic() - begun


def measure_before(bench):
    old, new = bench.given.before, bench.scancast
    cloud = cloud_of_both(bench)
    same = ["--shading", "unlit", "--color", "rgb", *camera(new, cloud)]
    own = {program: plain_flags(program) for program in (old, new)}
    rounds = 1 if bench.quick else gate.ROUNDS

    def frame(program, method, *flags, samples=1, views=None, only=None):
        def measured():
            try:
                stats = bench.turn(cloud, method, scancast=program, views=views, samples=samples,
                                   flags=[*same, *own[program], *flags])
            except Exception as problem:
                raise gate.Unable(str(problem)) from None
            return stage(stats, only) if only else without(stats, "encode")
        return measured

    rows = []

    def compare(name, unit, call):
        rows.append(gate.measured(name, unit, call(old), call(new), rounds, bench.given.limit))
        bench.log(" | ".join(row_words(vars(rows[-1]), bench.given.limit)))

    for method in bench.methods():
        compare(f"`{method}`", "ms", lambda program, m=method: frame(program, m))
    for method in bench.methods(*STILLS):
        compare(f"`{method}`, four samples", "ms", lambda program, m=method: frame(program, m, samples=4, views=2))
    compare("`point`, brute force", "ms", lambda program: frame(program, "point", "--brute-force", views=2))
    compare("the JPEG", "ms", lambda program: frame(program, "paraboloid", only="encode"))
    out = bench.path("gate.scan")
    for name, flags in (("with surfels", []), ("without", ["--no-surfels"])):
        compare(f"`ingest` {name}", "s", lambda program, f=flags: lambda: time_of(bench, [program, "ingest", bench.town_las(), "-o", out, "--force", "--quiet", *f]))
    return {"before": name_of(bench), "points": bench.points, "limit": bench.given.limit, "size": bench.size,
            "rows": [vars(row) for row in rows]}


def name_of(bench):
    """What it says of itself, and its commit, where it lies in a clone of its own."""
    folder, name = os.path.dirname(bench.given.before), bench.given.before_name
    if not name and machine.said("git", "-C", folder, "rev-parse", "--show-toplevel") not in ("", machine.ROOT):
        name = f"`{machine.commit(folder)['hash']}`"
    return f"{run([bench.given.before, '--version']).strip()} {name}".strip()


def slower(data):
    """Names of the rows that fail the gate."""
    return [row.name for row in gate.judged([gate.Row(**row) for row in data["rows"]], data["limit"])]


def row_words(row, limit):
    if row["says"]:
        return [row["name"], "-", "-", row["says"]]
    pairs = sorted(b / a for a, b in zip(row["old"], row["new"]))
    said = gate.verdict(row["old"], row["new"], limit)
    middle = lambda values: sorted(values)[len(values) // 2]
    return [row["name"], f"{number(middle(row['old']))} {row['unit']}", f"{number(middle(row['new']))} {row['unit']}",
            f"{gate.ratio(row['old'], row['new']):.2f} ({pairs[0]:.2f} - {pairs[-1]:.2f})" + ("" if said == "same" else f": **{said}**")]


def before_page(data):
    width, height = data["size"]
    drawn = [row for row in data["rows"] if not row["says"] and row["name"].count("`") == 2 and row["name"].endswith("`")]
    total = sum(sorted(r["new"])[len(r["new"]) // 2] for r in drawn) / sum(sorted(r["old"])[len(r["old"]) // 2] for r in drawn) if drawn else None
    return "\n\n".join([
        f"Beside {data['before']}, in turn, {width} x {height}, the town of {data['points'] / 1e6:g} million points in a cloud file that the other build wrote, the same flags for "
        f"both; what one of them draws without being asked is off. Time here over time there, pair by pair: median (lowest - highest). A row that is more than "
        f"{100 * (data['limit'] - 1):.0f} % slower, twice, ends the command with 1.",
        table(["", "before", "here", "ratio"], [row_words(row, data["limit"]) for row in data["rows"]]),
        *([f"The sum of all methods' frames: **{total:.2f}**."] if total else [])])
