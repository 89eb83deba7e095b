#!/usr/bin/env python3
"""How many lines of the product the tests run, room by room, from a build with -DSCANCAST_COVERAGE=ON.

  cmake --preset coverage && cmake --build --preset coverage && ctest --preset coverage
  tests/support/coverage.py build/coverage

A line counts where the compiler made code of it. The same line compiled several times - a header, a kernel for each
SIMD level - counts once, and is run when any of them was.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import subprocess
import sys

ROOMS = ("protocol", "files", "threads", "renderer", "transport", "server", "importers", "client")


def lines_of(note: pathlib.Path, root: pathlib.Path):
    """[(file, line, run)] of one object's notes (.gcno); its counts (.gcda) may be missing: then nothing ran."""
    told = subprocess.run(["gcov", "--json-format", "--stdout", str(note)], cwd=note.parent, capture_output=True)
    found = []
    for document in told.stdout.splitlines():
        for file in json.loads(document)["files"]:
            path = pathlib.Path(os.path.normpath(os.path.join(note.parent, file["file"])))
            if not path.is_relative_to(root):
                continue
            name = str(path.relative_to(root))
            if name.split("/")[0] in ROOMS:
                found += [(name, line["line_number"], line["count"] > 0) for line in file["lines"]]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, help="the build folder, after its tests ran")
    parser.add_argument("--files", action="store_true", help="each file, least covered first")
    options = parser.parse_args()
    build = options.build.resolve()
    home = next((line.split("=", 1)[1] for line in (build / "CMakeCache.txt").read_text().splitlines()
                 if line.startswith("CMAKE_HOME_DIRECTORY")), None)
    root = pathlib.Path(home)
    notes = sorted(build.rglob("*.gcno"))
    if not notes:
        sys.exit(f"{build} holds no coverage notes: configure it with -DSCANCAST_COVERAGE=ON")
    run = collections.defaultdict(dict)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for found in pool.map(lambda note: lines_of(note, root), notes):
            for name, line, hit in found:
                run[name][line] = run[name].get(line, False) or hit
    rooms = collections.defaultdict(lambda: [0, 0])
    for name, lines in run.items():
        for key in ("/".join(name.split("/")[:2]) if name.startswith("renderer") else name.split("/")[0], "all"):
            rooms[key][0] += sum(lines.values())
            rooms[key][1] += len(lines)
    if options.files:
        for name, lines in sorted(run.items(), key=lambda item: sum(item[1].values()) / len(item[1])):
            print(f"{100 * sum(lines.values()) / len(lines):6.2f} %  {sum(lines.values()):6d} of {len(lines):6d}  {name}")
    for room, (hit, all_lines) in sorted(rooms.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"{100 * hit / all_lines:6.2f} %  {hit:6d} of {all_lines:6d} lines  {room}")


if __name__ == "__main__":
    main()
