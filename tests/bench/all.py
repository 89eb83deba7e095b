#!/usr/bin/env python3
"""Every figure of docs/performance.md, measured anew by one command, and the page rewritten with them.

    tests/bench/all.py [--before OTHER/BUILD/bin/scancast]           # all, about an hour and a quarter on two cores; nothing else should run
    tests/bench/all.py --list                                        # what there is, how long it takes, what is missing here
    tests/bench/all.py --only fast,threads                           # some, printed; the page stays as it is (--out FILE writes one)
    tests/bench/all.py --only before --before old/bin/scancast       # has anything become slower?
    tests/bench/all.py --quick --only fast --out /tmp/page.md        # tiny sizes, to see that it works: figures mean nothing

The page has words, which stay, and blocks of figures between marks, which are replaced: nothing measured at another commit is left. What could not be
measured on this machine says why, and how to get it. Results are kept beneath build/figures, by commit, machine and sizes: a run that was
stopped goes on, and --again measures anew. Plots are SVG in docs/images/performance.

--before compares with another build, in turn, five rounds, medians of pairs: a row that is more than 10 % slower (--limit), in all rounds but one and
twice, ends the command with 1. Exit codes: 0; 1 something became slower; 2 wrong arguments, or programs that are not of this tree; 3 something that should
be measurable failed, which the page says in its place.

Needs the programs (./run.sh --build-only), some figures Debian's packages of deploy/packages/bench.txt, programs of -DSCANCAST_BENCH=ON and
real scans (--data). Python 3 alone is enough for the rest.
"""
import argparse
import os
import shutil
import signal
import sys
import time
import traceback

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [HERE, os.path.join(HERE, "..", "load")]
from figures import gate, machine, page, registry  # noqa: E402
from figures.bench import Bench  # noqa: E402
from figures.sections import before  # noqa: E402
from figures.store import Store  # noqa: E402

ROOT = machine.ROOT
PAGE = os.path.join(ROOT, "docs", "performance.md")
MACHINE = "machine"  # the one block that no section fills


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default=os.path.join(ROOT, "build/release/bin"), help="folder of the programs")
    parser.add_argument("--bench", default=os.path.join(ROOT, "build/bench/bench"), help="folder of the benchmarks' programs")
    parser.add_argument("--data", default=os.path.join(ROOT, "..", "shared", "data"), help="folder of real scans")
    parser.add_argument("--only", metavar="NAME,…", help="of these alone; prints them and leaves the page as it is, unless --out says where one goes")
    parser.add_argument("--list", action="store_true", help="tell what there is, and what is missing here")
    parser.add_argument("--quick", action="store_true", help="tiny sizes: shows that it works")
    parser.add_argument("--points", default="20M", help="of the town; by default %(default)s")
    parser.add_argument("--points-up-to", default="100M", help="of time over points; by default %(default)s, at most 1G")
    parser.add_argument("--before", metavar="PROGRAM", help="another build's scancast, to compare with in turn")
    parser.add_argument("--before-name", default="", metavar="TEXT", help="what to call it on the page, such as its commit")
    parser.add_argument("--limit", type=float, default=gate.LIMIT, help="how many times as long is too long; by default %(default)s")
    parser.add_argument("--gpu-results", metavar="FOLDER", help="what gpu_day.sh left, of a run of this commit on another machine")
    parser.add_argument("--tests-log", metavar="FILE", help="what ./test.sh of this commit printed")
    parser.add_argument("--out", metavar="FILE", help="the page to write; by default docs/performance.md, where all is measured")
    parser.add_argument("--plots", metavar="FOLDER", help="where plots go; by default docs/images/performance, or images beside --out")
    parser.add_argument("--folder", metavar="FOLDER", help="where clouds are made; by default build/figures")
    parser.add_argument("--again", action="store_true", help="measure again what this commit has measured already")
    given = parser.parse_args(words)
    try:
        given.sections = registry.named(given.only.split(",")) if given.only else registry.SECTIONS
        Bench(given, "")  # sizes are sizes
    except ValueError as problem:
        parser.error(str(problem))
    if given.limit <= 1:
        parser.error("--limit: how many times as long is too long, such as 1.1")
    if given.quick and not given.out and not given.only:
        parser.error("--quick makes figures that mean nothing, and does not write docs/performance.md: say --out FILE or --only NAME,…")
    if given.out and not os.path.isdir(os.path.dirname(os.path.abspath(given.out))):
        parser.error(f"--out: there is no folder {os.path.dirname(os.path.abspath(given.out))}")
    given.bin, given.bench = os.path.abspath(given.bin), os.path.abspath(given.bench)
    given.before = os.path.abspath(given.before) if given.before else None
    return given


def about(given, build):
    scancast = os.path.join(given.bin, "scancast")
    return {"commit": machine.commit(), "machine": machine.machine(scancast), "compiler": machine.compiler(build), "libraries": machine.libraries(scancast),
            "quick": given.quick}


def stamp(path):
    """What a file's or folder's content is taken by: another one there, or a newer one, is measured or read anew."""
    return {"path": os.path.abspath(path), "changed": os.path.getmtime(path) if os.path.exists(path) else 0} if path else None


def asked_with(given, section):
    """What else a section's figures depend on; another answer measures it anew."""
    own = {"before": lambda: {"points": given.points, "before": stamp(given.before)},
           "points": lambda: {"upTo": given.points_up_to},
           "gpu": lambda: {"results": stamp(given.gpu_results)},
           "tests": lambda: {"log": stamp(given.tests_log)}}
    return {"points": given.points, "data": os.path.abspath(given.data), **own.get(section.name, dict)()}


def listed(bench):
    print(f"{'name':12} {'minutes':>7}  heading")
    total = 0
    for section in registry.SECTIONS:
        print(f"{section.name:12} {section.minutes:7g}  {section.heading}{' (only where --only names it)' if section.asked else ''}")
        if lacking := section.missing(bench):
            print(f"{'':21} missing: {lacking}")
        elif not section.asked:
            total += section.minutes
    print(f"\nAll that can be measured here: about {total} minutes on two cores. Needs nothing else to run meanwhile.")


def wanted_of(given, bench, store):
    """(those to measure, {name: why not})."""
    to_do, why = [], {}
    for section in given.sections:
        kept = store.get(section.name)
        if kept and not given.again and kept.get("with") == asked_with(given, section):
            continue
        lacking = "not asked for: it takes long (`--only " + section.name + "`)" if section.asked and not given.only else section.missing(bench)
        if lacking and kept:
            continue  # it was not missing then, and it is the same commit on the same machine
        if lacking:
            why[section.name] = lacking
        else:
            to_do.append(section)
    return to_do, why


def clock(minutes):
    return f"{minutes:.0f} min" if minutes >= 1 else "less than a minute"


def measured(to_do, bench, store, why):
    """Measures them in turn, and keeps each at once. True where one failed."""
    failed, spent, planned = False, 0.0, 0.0
    for number, section in enumerate(to_do, 1):
        pace = spent / planned if planned > 2 else 0.05 if bench.quick else 1  # of this machine, beside the two cores that the minutes are of
        left = sum(other.minutes for other in to_do[number - 1:]) * pace
        print(f"[{number}/{len(to_do)}] {section.heading} ({section.name}): about {clock(section.minutes * pace)}, of {clock(left)} that are left", file=sys.stderr, flush=True)
        begun = time.monotonic()
        try:
            data = section.measure(bench)
            section.page(data)  # what cannot be told is not kept
        except KeyboardInterrupt:
            raise SystemExit("stopped; what was measured is kept, and the same command goes on there") from None
        except (Exception, SystemExit) as problem:  # one benchmark's fault leaves the others alone, and stands on the page
            bench.log(traceback.format_exc())
            failed, why[section.name] = True, f"it failed: {problem or type(problem).__name__}"
            print(f"  FAILED: {problem or type(problem).__name__} ({bench.path('all.log')} has more)", file=sys.stderr, flush=True)
            continue
        finally:
            spent, planned = spent + (time.monotonic() - begun) / 60, planned + section.minutes
        store.put(section.name, {"date": machine.today(), "seconds": round(time.monotonic() - begun, 1), "with": asked_with(bench.given, section), "data": data})
    return failed


def figures(given, store, why, plots_at):
    """{block: Markdown} of all sections, those that were not asked for, too."""
    found, dates = {}, sorted(store.get(s.name)["date"] for s in registry.SECTIONS if store.get(s.name))
    made = store.about["commit"]["hash"]
    for section in registry.SECTIONS:
        kept = store.get(section.name)
        if kept and section.name not in why:
            text = section.page(kept["data"]).replace("(PLOTS/", f"({plots_at}/")
            found[section.name] = f"{text}\n\nMeasured at `{made}`, {kept['date']}: `{section.command}`."
        else:
            found[section.name] = f"Not measured at `{made}`: {why.get(section.name) or f'not asked for (`--only {section.name}`)'}."
    found[MACHINE] = machine.words(store.about, dates) + ("\n\n**Made with `--quick`: these figures mean nothing.**" if given.quick else "")
    return found


def write_plots(store, folder):
    for section in registry.SECTIONS:
        kept = store.get(section.name)
        for name, svg in (section.plots(kept["data"]) if section.plots and kept else {}).items():
            os.makedirs(folder, exist_ok=True)
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write(svg)


def write(given, store, why):
    out = os.path.abspath(given.out or PAGE)
    plots = os.path.abspath(given.plots or (os.path.join(ROOT, "docs", "images", "performance") if out == PAGE else os.path.join(os.path.dirname(out), "images")))
    with open(PAGE, encoding="utf-8") as file:
        text = page.rewritten(file.read(), figures(given, store, why, os.path.relpath(plots, os.path.dirname(out)).replace(os.sep, "/")))
    write_plots(store, plots)
    with open(out + ".unfinished", "w", encoding="utf-8") as file:
        file.write(text)
    os.replace(out + ".unfinished", out)
    print(f"written: {out}, plots: {plots}", file=sys.stderr)


def main(words=None):
    given = parse(words)
    if not os.access(os.path.join(given.bin, "scancast"), os.X_OK):
        print(f"all.py: there is no scancast in {given.bin}; ./run.sh --build-only builds it", file=sys.stderr)
        return 2
    build = os.path.normpath(os.path.join(given.bin, ".."))
    folder = os.path.abspath(given.folder or os.path.join(ROOT, "build", "figures"))
    os.makedirs(folder, exist_ok=True)
    if given.list:
        listed(Bench(given, folder))
        return 0
    if not given.quick and (why := machine.stale(build)):
        print(f"all.py: {why}", file=sys.stderr)
        return 2
    known = about(given, build)
    store = Store(os.path.join(folder, f"{known['commit']['key']}{'-quick' if given.quick else ''}.json"), known)
    clouds = os.path.join(folder, f"work-{known['commit']['key']}{'-quick' if given.quick else ''}-{os.getpid()}")
    os.makedirs(clouds)
    bench = Bench(given, clouds)
    try:
        to_do, why = wanted_of(given, bench, store)
        failed = measured(to_do, bench, store, why)
        log = bench.path("all.log")
        if os.path.exists(log):
            shutil.copy(log, os.path.join(folder, "all.log"))
    finally:
        shutil.rmtree(clouds, ignore_errors=True)
    if given.only:
        text = figures(given, store, why, "images")
        for section in given.sections:
            print(f"## {section.heading}\n\n{text[section.name]}\n")
    if given.out or not given.only:
        write(given, store, why)
    gate_section, kept = registry.named(["before"])[0], store.get("before")
    worse = before.slower(kept["data"]) if gate_section in given.sections and kept and kept["with"] == asked_with(given, gate_section) else []
    if worse:
        print(f"all.py: more than {100 * (given.limit - 1):.0f} % slower than {given.before}: {', '.join(worse)}", file=sys.stderr)
    return 1 if worse else 3 if failed else 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # as Ctrl-C: servers end, clouds are removed
    sys.exit(main())
