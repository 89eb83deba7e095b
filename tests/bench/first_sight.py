#!/usr/bin/python3
"""How good the first picture of a scan is: the one that `scancast render FILE -o X.png` draws, with no option at all.

    tests/bench/first_sight.py [--scancast PROGRAM] [--data FOLDER] [--half even|odd|all] [--jobs N] [--out FOLDER]
                               [--json FILE] [--sheet FILE.png] [--unknown-as object|landscape] FILES... [-- FLAGS]

FILES are what scancast reads; of an octree of EPT or Potree its folder, or its ept.json, cloud.js or metadata.json. --data adds all scans beneath a
folder. FLAGS go to every `scancast render`. Of each scan:
  fill     the box from the 1st to the 99th percentile of covered columns and rows takes 75 % of the width or height at least;
  middle   its middle is at most 8 % of width and height off the picture's;
  border   of the outermost pixels at most 2 % are covered: 60 % where `scancast look` says that the scan is a landscape (kind airborne, street), is seen from inside (indoor, depth-frame, or inside: true).
           A scan of which it says nothing is an object, or what --unknown-as says;
  spread   luminance of covered pixels: 0.25 at least from the 5th to the 95th percentile;
  median   its median is 0.12 to 0.85;
  colour   no single colour of 4 bits a channel takes more than 35 % of the covered pixels;
  edges    3 % of the covered pixels at least lie where luminance changes by more than 0.08 a pixel;
  noise    a scan with colours: pixels differ from the median around them no more than in a picture of its points alone.
sight/measure.py says how each is measured. Covered pixels are told by a second picture, --background transparent; the points'
noise by a third. Not scored: scans of less than 5,000 points ("small"), and what cannot be read.

--half even scores, and opens, only scans whose base name has an even CRC-32: those to try things on. The odd ones are held
back for the end. An octree's base name is that of its index file.

Prints a line a scan with what failed, then the rates. Ends with 0 whatever they are, with 2 when nothing could be drawn.
--out keeps the pictures, --sheet draws a contact sheet of them, --json has all numbers.
"""
import argparse
import json
import multiprocessing
import os
import re
import subprocess
import sys
import tempfile
import time
import zlib
from collections import Counter
from typing import NamedTuple

import png_file
from sight import measure, sheet

ENDINGS = (".las", ".laz", ".ply", ".pcd", ".e57", ".pts", ".ptx", ".xyz", ".txt", ".csv")  # .copc.laz is a .laz
INDEXES = ("ept.json", "cloud.js", "metadata.json")
LEFT_OUT = "bad"  # folders of files that are meant not to be read
SMALL = 5000
PATIENCE = 600    # seconds for one call of scancast
CUT_OUT = {"--background": "transparent"}
POINTS = {**CUT_OUT, "--color": "rgb", "--method": "point", "--shading": "unlit"}
MUCH_UNLIKE = 0.01  # of the covered pixels
LONGEST_ERROR = 110  # characters, in the table
HALVES = {"even": ("try", 0), "odd": ("held back", 1)}


class Job(NamedTuple):
    scan: str      # what scancast is given
    name: str      # for people, and of pictures
    program: str
    flags: list
    folder: str    # where its pictures go
    unknown_as: str


def index_of(path):
    """An octree by its index, whichever way it is named."""
    return next((os.path.join(path, name) for name in INDEXES if os.path.isfile(os.path.join(path, name))), path)


def scans_beneath(folder):
    for here, folders, names in os.walk(folder):
        folders[:] = sorted(name for name in folders if name != LEFT_OUT)
        if index := [name for name in INDEXES if name in names]:
            folders[:] = []  # what else is here belongs to the octree
            yield os.path.join(here, index[0])
        else:
            yield from (os.path.join(here, name) for name in sorted(names) if name.lower().endswith(ENDINGS))


def half_of(path):
    return "odd" if zlib.crc32(os.path.basename(path).encode()) % 2 else "even"


def names_of(scans):
    """A name each that can be a file's, no two alike: the base name, of an octree its folder's."""
    names = []
    for path in scans:
        base = os.path.basename(path)
        name = os.path.basename(os.path.dirname(os.path.abspath(path))) if base in INDEXES else base
        name = again = re.sub(r"[^\w.+-]+", "_", name)
        number = 2
        while again in names:
            again, number = f"{name}.{number}", number + 1
        names.append(again)
    return names


def with_words(flags, words):
    """Flags of `scancast render` with these in the place of what they say of the same words."""
    kept, skip = [], False
    for flag in flags:
        if skip:
            skip = False
        elif flag in words:
            skip = True
        elif flag.split("=")[0] not in words:
            kept.append(flag)
    return kept + [part for word in words.items() for part in word]


def called(*command):
    """Standard output and the error's first line; progress bars are no errors."""
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, stdin=subprocess.DEVNULL, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return "", f"no answer within {PATIENCE} s"
    if done.returncode == 0:
        return done.stdout.decode(errors="replace"), None
    lines = re.split(r"[\r\n]+", done.stderr.decode(errors="replace"))
    said = [line for line in lines if line.strip() and not re.match(r"\s*\d+ %", line)]
    return done.stdout.decode(errors="replace"), said[0] if said else f"ended with {done.returncode}"


def described(job):
    """What scancast says of the scan, and why it says nothing. --check, so that points are counted and colours that are the same
    everywhere are none."""
    said, error = called(job.program, "info", "--check", "--json", job.scan)
    try:
        about = json.loads(said)["files"][0]
    except (ValueError, LookupError):
        return None, error or "scancast info says nothing"
    if "error" in about:
        return None, (about["error"].get("message") or "it does not say why").split("\n")[0]
    return about, None


def look_of(job):
    """How scancast chose to show the scan: its kind, and whether it is first seen from inside; None of programs before it could."""
    try:
        look = json.loads(called(job.program, "look", job.scan)[0])
        return {"kind": look["kind"], "inside": look["views"][0]["inside"], "view": look["views"][0]["name"], "reason": look["reason"]}
    except (ValueError, LookupError):
        return None


def drawn(job, kind, flags):
    """Path of a picture, and why there is none."""
    path = os.path.join(job.folder, job.name + kind)
    _, error = called(job.program, "render", job.scan, "-o", path, *flags)
    return path, error


def looked_at(job):
    """Everything about one scan, as --json has it, and its thumbnail."""
    found = {"name": job.name, "file": job.scan, "half": half_of(job.scan), "state": "unreadable"}
    about, error = described(job)
    if error is None:
        look = look_of(job)
        found |= {"points": about["points"], "format": about.get("format"), "look": look,
                  "coloured": bool((about.get("attributes") or {}).get("color"))}
        path, error = drawn(job, ".png", job.flags)
    if error is not None:
        return found | {"error": error}, None
    try:
        seen = png_file.read(path)
        small = sheet.shrunk(seen)
        if about["points"] is not None and about["points"] < SMALL:
            return found | {"state": "small"}, small
        others = []
        for kind, words in ((".cut-out.png", CUT_OUT), (".points.png", POINTS))[:2 if found["coloured"] else 1]:
            path, error = drawn(job, kind, with_words(job.flags, words))
            if error is not None:
                return found | {"error": error}, None
            others.append(png_file.read(path))
        numbers = measure.measured(seen, *others)
    except (OSError, ValueError) as problem:
        return found | {"error": str(problem)}, None
    failed = measure.failed(numbers, measure.touched_allowed(look, job.unknown_as))
    return found | {"state": "fail" if failed else "pass", "failed": dict(failed), "numbers": numbers}, small


def kind_of(found):
    look = found.get("look")
    return " ".join([str(look.get("kind")), *(["inside"] if look.get("inside") else [])]) if isinstance(look, dict) else "-"


def told(found, longest):
    """One line."""
    if found["state"] == "unreadable":
        said = found["error"].replace(found["file"], "").lstrip(",: ")
        said = said if len(said) <= LONGEST_ERROR else said[:LONGEST_ERROR] + " ..."
    elif found["state"] == "small":
        said = f"{found['points']:,} points, not scored"
    else:
        said = "; ".join(f"{criterion} {sentence}" for criterion, sentence in found["failed"].items())
        if found["numbers"].get("unlike", 0) > MUCH_UNLIKE:
            said += f" (NOTE: {found['numbers']['unlike']:.0%} of its pixels are others with a transparent background)"
    return f"{found['name']:<{longest}}  {HALVES[found['half']][0]:<9}  {kind_of(found):<11}  {found['state']:<10}  {said}".rstrip()


def rates(results):
    """{set: [passed, scored]} of the sets of which something was scored."""
    found = {}
    for result in results:
        if result["state"] in ("pass", "fail"):
            for name in ("all", HALVES[result["half"]][0]):
                row = found.setdefault(name, [0, 0])
                row[0] += result["state"] == "pass"
                row[1] += 1
    return found


def summary(results):
    for name, (passed, scored) in rates(results).items():
        yield f"{name}: {passed} of {scored} pass ({passed / scored:.0%})"
    failures = Counter(criterion for result in results for criterion in result.get("failed", ()))
    if failures:
        yield "failed: " + ", ".join(f"{criterion} {count}" for criterion, count in failures.most_common())
    for state in ("small", "unreadable"):
        if names := [result["name"] for result in results if result["state"] == state]:
            yield f"{state}: {len(names)} ({', '.join(names)})"


def entry_of(found, small):
    if found["state"] == "small":
        return sheet.Entry(found["name"], "small", f"{found['points']:,} points, not scored", small)
    return sheet.Entry(found["name"], found["state"], ", ".join(found["failed"]) or "all criteria hold", small)


def parsed(words):
    flags = []
    if "--" in words:
        words, flags = words[:words.index("--")], words[words.index("--") + 1:]
    root = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", metavar="FILES", nargs="*", help="scans")
    parser.add_argument("--scancast", metavar="PROGRAM", default=os.path.join(root, "build/release/bin/scancast"), help="by default %(default)s")
    parser.add_argument("--data", metavar="FOLDER", help=f"all scans beneath it, those in folders named {LEFT_OUT} left out")
    parser.add_argument("--half", choices=["even", "odd", "all"], default="all", help="by default %(default)s")
    parser.add_argument("--jobs", metavar="N", type=int, default=2, help="so many scans at once; by default %(default)s")
    parser.add_argument("--out", metavar="FOLDER", help="keep the pictures here")
    parser.add_argument("--json", metavar="FILE", help="all numbers")
    parser.add_argument("--sheet", metavar="FILE.png", help="contact sheet")
    parser.add_argument("--unknown-as", choices=["object", "landscape"], default="object",
                        help="what a scan is of which scancast does not say it; by default %(default)s")
    arguments = parser.parse_args(words)
    if arguments.data and not os.path.isdir(arguments.data):
        parser.error(f"{arguments.data} is no folder")
    if not arguments.files and not arguments.data:
        parser.error("name scans, or a folder of them with --data")
    if arguments.jobs < 1:
        parser.error("--jobs is 1 at least")
    if not os.access(arguments.scancast, os.X_OK):
        parser.error(f"{arguments.scancast} is no program; --scancast names it")
    return arguments, flags


def run(arguments, flags, folder):
    """[(what was found, thumbnail or None)], printed as they come."""
    scans = [index_of(path) for path in arguments.files] + list(scans_beneath(arguments.data) if arguments.data else ())
    kept = [path for path in scans if arguments.half in ("all", half_of(path))]
    if len(kept) < len(scans):
        print(f"{len(scans) - len(kept)} of {len(scans)} scans are of the other half, and not opened", flush=True)
    jobs = [Job(path, name, os.path.abspath(arguments.scancast), flags, folder, arguments.unknown_as)
            for path, name in zip(kept, names_of(kept))]
    longest, results = max((len(job.name) for job in jobs), default=0), []
    with multiprocessing.Pool(arguments.jobs) as pool:
        for found, small in pool.imap(looked_at, jobs):
            print(told(found, longest), flush=True)
            results.append((found, small))
    return results


def main():
    arguments, flags = parsed(sys.argv[1:])
    start = time.monotonic()
    with tempfile.TemporaryDirectory() as temporary:
        if arguments.out:
            os.makedirs(arguments.out, exist_ok=True)
        results = run(arguments, flags, arguments.out or temporary)
    found = [result for result, _ in results]
    print()
    for line in summary(found):
        print(line)
    print(f"{len(found)} scans, {time.monotonic() - start:.0f} s")
    if arguments.json:
        with open(arguments.json, "w", encoding="utf-8") as file:
            json.dump({"program": arguments.scancast, "flags": flags, "half": arguments.half, "rates": rates(found), "scans": found}, file, indent=1)
            file.write("\n")
    shown = sorted((pair for pair in results if pair[1]), key=lambda pair: pair[0]["state"] == "small")  # those come last
    picture = sheet.sheet([entry_of(*pair) for pair in shown])
    if arguments.sheet and picture:
        png_file.write(arguments.sheet, picture)
    sys.exit(0 if picture else 2)


if __name__ == "__main__":
    main()
