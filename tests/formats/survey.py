#!/usr/bin/env python3
"""Tries every scan of a folder, and holds what scancast says against what an independent reader finds (declared/).

    tests/formats/survey.py FOLDER --scancast build/release/bin/scancast -o table.md

Each file is read to its end by `scancast info --check`, two at a time, at the lowest priority, with limits of time and memory. Prints a
table by format, and under it what is to be looked at. A point that was dropped and told counts as read. Octrees in folders are one
file each; the same content met twice is tried once. Exit code 1: a fault (a crash, a file that takes too long or too much, a refusal
without a reason) or a difference.
"""
import argparse
import collections
import concurrent.futures
import fnmatch
import hashlib
import json
import multiprocessing
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

from declared.examine import examine
from declared.octrees import kind_of

# What an importer or the program says when it did not end as it should.
FAULTY = re.compile(r"crashed|it hangs|made a system call|killed by the system|used more processor time|ran out of memory"
                    r"|out of memory|bad_alloc|uncaught|AddressSanitizer|runtime error:|the program \S+ that reads this", re.I)


class Tried:
    """One file, and what became of it: outcome is equal, different, uncounted, refused or fault."""

    def __init__(self, path, name):
        self.path, self.name = path, name
        self.witness, self.outcome, self.words = None, "", ""
        self.points, self.seconds, self.memory, self.notes, self.claim = 0, 0.0, 0, [], ""


def found_in(folder, skipped):
    """Files, and folders that are one octree, in order of their names; what is the same is there once."""
    seen = set()
    for root, folders, files in os.walk(folder):
        folders.sort()
        if any(fnmatch.fnmatch(os.path.relpath(root, folder), pattern) for pattern in skipped):
            folders.clear()
            continue
        if kind_of(files):
            folders.clear()
            yield root
            continue
        for name in sorted(files):
            path = os.path.join(root, name)
            if not os.path.isfile(path) or any(fnmatch.fnmatch(os.path.relpath(path, folder), p) for p in skipped):
                continue
            with open(path, "rb") as file:
                digest = hashlib.file_digest(file, "sha256").digest()
            if digest not in seen:
                seen.add(digest)
                yield path


def run(command, seconds, memory):
    """(exit code or None for too slow, standard output, standard error, processor seconds, peak memory in bytes)"""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        limited = ["prlimit", f"--data={memory or 'unlimited'}", "--core=0", *command]
        process = subprocess.Popen(limited, stdin=subprocess.DEVNULL, stdout=out, stderr=err, start_new_session=True)
        end = time.monotonic() + seconds
        ended, slow = 0, False
        while True:
            ended, status, usage = os.wait4(process.pid, os.WNOHANG)
            if ended:
                break
            if not slow and time.monotonic() > end:
                os.killpg(process.pid, signal.SIGKILL)
                slow = True
            time.sleep(0.01)
        process.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0), err.seek(0)
        return (None if slow else process.returncode, out.read().decode("utf-8", "replace"), err.read().decode("utf-8", "replace"),
                usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def reason_in(message, path):
    """The message as it would be of any file: without its name, numbers and quotations."""
    text = re.sub("^" + re.escape(os.path.basename(path)), "FILE", message.replace(path, "FILE"))
    text = re.sub(r"\s*Scancast reads .*", "", text)
    text = re.sub(r"^FILE(, (byte|line) \d+)?:\s*", "", re.sub(r"^scancast info:\s*", "", text.strip()))
    return text


def attempt(tried, witnesses, options):
    """`witnesses`: processes, since a process counts as its own memory what it was forked from."""
    tried.witness = witnesses.submit(examine, tried.path).result()
    code, out, err, tried.seconds, tried.memory = run(
        [options.scancast, "info", "--check", "--json", "--quiet", tried.path], options.timeout, options.memory)
    if code is None:
        tried.outcome, tried.words = "fault", f"not ready after {options.timeout} s"
    elif code not in (0, 1):
        tried.outcome, tried.words = "fault", f"exit code {code}: {err.strip()[-300:]}"
    elif FAULTY.search(err):
        tried.outcome, tried.words = "fault", reason_in(err, tried.path)[:300]
    else:
        try:
            told = json.loads(out)["files"][0]
        except (ValueError, KeyError, IndexError):
            tried.outcome, tried.words = "fault", "its answer is no JSON"
            return tried
        judge(tried, told, code)
    return tried


def judge(tried, told, code):
    if "error" in told:
        tried.words = reason_in(told["error"].get("message", ""), tried.path)
        tried.outcome = "refused"
        if FAULTY.search(tried.words):
            tried.outcome = "fault"
        elif len(tried.words.split()) < 3 or code != 1:
            tried.outcome, tried.words = "fault", f"refused without a reason, or with exit code 0: {tried.words!r}"
        return
    tried.points, tried.notes = told["points"], told["notes"]
    witness = tried.witness
    if witness.broken or witness.points is None:
        tried.outcome, tried.words = "uncounted", witness.broken
        return
    differences = list(compare(witness, told))
    tried.outcome, tried.words = ("different", "; ".join(differences)) if differences else ("equal", "")
    if witness.declared and told["points"] and not alike(witness.declared, told["bounds"], max(100 * witness.step, 1e-6)):
        tried.claim = f"from {told['bounds'][0]} to {told['bounds'][1]}, declared from {witness.declared[0]} to {witness.declared[1]}"


def compare(witness, told):
    """What differs, in words."""
    whole = told["points"] + told["droppedPoints"]
    if whole != witness.points:
        yield f"{told['points']} points and {told['droppedPoints']} dropped, not {witness.points}"
    if witness.bounds and told["points"] and told["bounds"] and not alike(witness.bounds, told["bounds"], witness.step):
        yield f"from {told['bounds'][0]} to {told['bounds'][1]}, not from {witness.bounds[0]} to {witness.bounds[1]}"
    if witness.intensity and told["attributes"]["intensity"] and tuple(told["intensityRange"]) != witness.intensity:
        yield f"intensities {told['intensityRange']}, not {witness.intensity}"
    if witness.classes and told["classes"]:
        classes = {row["class"]: row["points"] for row in told["classes"]}
        if classes != witness.classes:
            yield f"classes {classes}, not {witness.classes}"


def alike(one, other, step):
    return all(abs(a - b) <= max(step, 1e-9 * abs(a), 2e-7 * abs(a) if step == 1e-6 else 0)
               for ends in zip(one, other) for a, b in zip(*ends))


def table(all_tried):
    lines = ["| format | tried | read | counts equal | different | nobody else counted | refused | of them whole | faults | points | most memory |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    rows = collections.defaultdict(list)
    for tried in all_tried:
        rows[tried.witness.format].append(tried)
    order = sorted(rows, key=lambda row: (row == "other", row.lower()))
    for row, some in [(row, rows[row]) for row in order] + [("all", all_tried)]:
        count = collections.Counter(tried.outcome for tried in some)
        read = count["equal"] + count["different"] + count["uncounted"]
        peak = max((tried.memory for tried in some), default=0)
        lines.append(f"| {row} | {len(some)} | {read} | {count['equal']} | {count['different']} | {count['uncounted']} | "
                     f"{count['refused']} | {sum(map(refused_though_whole, some))} | {count['fault']} | "
                     f"{sum(tried.points for tried in some):,} | {peak / 1e6:.0f} MB |")
    return lines


def refused_though_whole(tried):
    return tried.outcome == "refused" and not tried.witness.broken and bool(tried.witness.points)


def refusals(all_tried):
    """Sentences, each once, with how often it was said and one file that it was said of."""
    groups = collections.defaultdict(list)
    for tried in all_tried:
        if tried.outcome == "refused":
            alike_words = re.sub(r"\"[^\"]*\"", '"…"', re.sub(r"\(it starts with[^)]*\)", "(it starts with …)", tried.words))
            groups[tried.witness.format, re.sub(r"-?\d[\d.,]*(?<!\.)", "N", alike_words)].append(tried)
    lines = ["| refused | times | for example |", "|---|---|---|"]
    for (row, _), some in sorted(groups.items(), key=lambda group: (-len(group[1]), group[0])):
        sentence = some[0].words.replace("|", "\\|").replace("\n", " ")
        lines.append(f"| {row}: {sentence} | {len(some)} | {os.path.basename(some[0].path)} |")
    return lines


def to_look_at(all_tried):
    kinds = (("Faults", lambda t: t.outcome == "fault"), ("Different", lambda t: t.outcome == "different"),
             ("Refused though whole", refused_though_whole),
             ("Read, though the other reader finds it broken; no note", lambda t: t.outcome == "uncounted" and t.witness.broken and not t.notes),
             ("Read, with a note, though the other reader finds it broken", lambda t: t.outcome == "uncounted" and t.witness.broken and t.notes),
             ("Read, of a format that nobody here knows", lambda t: t.outcome == "uncounted" and not t.witness.broken),
             ("Read, the bounds other than the file declares (most often the writer's mistake)", lambda t: t.claim))
    for title, belongs in kinds:
        some = [tried for tried in all_tried if belongs(tried)]
        if some:
            yield f"\n{title}:"
            yield from (f"- {t.name}: {t.words or t.claim}" + (f" ({'; '.join(t.notes)})" if t.notes else "") for t in some)


def size(text):
    number, unit = re.fullmatch(r"(\d+)([kMG]?)", text).groups()
    return int(number) * {"": 1, "k": 10**3, "M": 10**6, "G": 10**9}[unit]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", help="what lies below it is tried")
    parser.add_argument("--scancast", required=True, help="the program, its importers beside it")
    parser.add_argument("-o", "--output", help="where the two tables go, as Markdown")
    parser.add_argument("--timeout", type=float, default=120, metavar="SECONDS", help="a file's time (%(default)s)")
    parser.add_argument("--memory", type=size, default="4G", metavar="SIZE", help="a process's data (%(default)s); 0: any")
    parser.add_argument("--jobs", type=int, default=2, help="files at a time (%(default)s)")
    parser.add_argument("--skip", action="append", default=[], metavar="PATTERN", help="of paths below the folder")
    options = parser.parse_args()
    options.scancast = os.path.abspath(options.scancast)
    tries = [Tried(path, os.path.relpath(path, options.folder)) for path in found_in(options.folder, options.skip)]
    os.nice(19)
    with (concurrent.futures.ProcessPoolExecutor(options.jobs, multiprocessing.get_context("spawn")) as witnesses,
          concurrent.futures.ThreadPoolExecutor(options.jobs) as pool):
        all_tried = list(pool.map(lambda tried: attempt(tried, witnesses, options), tries))
    tables = table(all_tried) + [""] + refusals(all_tried)
    print("\n".join(tables))
    print("\n".join(to_look_at(all_tried)))
    print(f"\n{sum(t.points for t in all_tried):,} points in {sum(t.seconds for t in all_tried):.0f} s of processor time")
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write("\n".join(tables) + "\n")
    return 1 if any(tried.outcome in ("fault", "different") for tried in all_tried) else 0


if __name__ == "__main__":
    sys.exit(main())
