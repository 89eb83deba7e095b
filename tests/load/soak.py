#!/usr/bin/env python3
"""Lets a server work for long, at four fifths of the machine, while things go wrong around it.

    tests/load/soak.py --minutes 30 [--bin build/release/bin] [--points 2M] [--gap 500] [--seed 1]

Generates two clouds and serves them: streams, MJPEG streams and snapshots that nobody has asked for, as many as keep the server at 80 % of the
processor time of its cores; beside them a polite viewer. Every few seconds a fault (faults.py): clients that vanish, heads that do not end, readers that do not
read, the cloud file replaced, cut short and mended, an importer killed, a disk that is full, SIGHUP. Prints a line a minute.

Ends with 1 when memory went beyond the limit and a quarter; when descriptors or threads grew from the first third of the time to the last; when /readyz was not 200,
or an answer was none that such a request deserves; when the polite viewer waited longer than --gap ms for a frame; when a picture was wrong, of the cloud that is left
alone or of the one whose file changes; or when the server did not end as it should.
"""
import argparse
import collections
import os
import re
import secrets
import statistics
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "attack"))
import faults  # noqa: E402
import polite  # noqa: E402
import serving  # noqa: E402

MEMORY_LIMIT = 512 << 20
SHARE = 0.8
PICTURE = "width=320&height=200"


class Moving:
    """The cloud whose file changes: every picture of it is one of those that it may be, or says that it lacks something."""

    def __init__(self, server, cloud, path):
        self.server, self.path, self.cloud = server, path, cloud
        self.pictures, self.wrong = {}, []

    def picture(self):
        return self.server.get(f"/api/v1/clouds/{self.cloud}/snapshot.png?{PICTURE}")

    def learn(self, version):
        self.pictures[version] = self.picture()[2]

    def look(self):
        """Which version is shown; None = none, or not all of it."""
        status, headers, body = self.picture()
        if status != 200 or "Scancast-Damaged" in headers:
            return None
        for version, picture in self.pictures.items():
            if body == picture:
                return version
        self.wrong.append(f"a picture of {len(body)} bytes of the changing cloud that is none of its versions")
        return None


class Load:
    """Threads that ask, and pause so long that the server is as busy as it shall be."""

    def __init__(self, server):
        self.server, self.pause, self.done = server, 0.2, threading.Event()
        self.answers, self.unexpected, self.lock = collections.Counter(), [], threading.Lock()
        self.threads = [threading.Thread(target=self.run, args=(act, number), daemon=True)
                        for number, act in enumerate([self.snapshot] * 4 + [self.mjpeg] * 2 + [self.stream] * 2)]
        for thread in self.threads:
            thread.start()

    def count(self, what, fault=None):
        with self.lock:
            self.answers[what] += 1
            if fault:
                self.unexpected.append(fault)

    def run(self, act, number):
        while not self.done.is_set():
            try:
                act(number)
            except (OSError, ValueError) as error:
                if not self.done.is_set():
                    self.count("error", f"{act.__name__}: {error!r}")
            self.done.wait(self.pause)

    def snapshot(self, number):
        words = f"width=960&height=540&eye={number * 10},{time.monotonic() % 100:.5f},300"
        status, headers, body = self.server.get(self.server.snapshot(words))
        sound = status == 200 or (status in (429, 503) and "Retry-After" in headers)
        self.count(status, None if sound else f"a snapshot was answered {status}: {body[:200]}")

    def mjpeg(self, number):
        connection = self.server.connect()
        connection.request("GET", f"/api/v1/clouds/{self.server.cloud}/stream.mjpg?width=480&height=270&fps=10")
        answer = connection.getresponse()
        sound = answer.status == 200 or answer.status == 503
        self.count(f"mjpeg {answer.status}", None if sound else f"an MJPEG stream was answered {answer.status}")
        answer.read(20_000)
        connection.close()

    def stream(self, number):
        viewer = polite.PoliteViewer(self.server.address, 480, 270, fps=10)
        self.done.wait(15)
        viewer.stop()
        self.count("stream", viewer.failure or (None if viewer.arrivals else "a stream got no frame"))

    def adjust(self, share):
        """Of the cores, that the server has used lately."""
        if share > SHARE + 0.05:
            self.pause = min(self.pause * 1.3, 5)
        elif share < SHARE - 0.05:
            self.pause = max(self.pause / 1.3, 0.005)

    def stop(self):
        self.done.set()
        for thread in self.threads:
            thread.join(30)


class Watch:
    """Looks at the server once a second."""

    def __init__(self, server, load):
        self.server, self.load, self.samples, self.faults = server, load, [], []
        self.done, self.cores = threading.Event(), len(os.sched_getaffinity(0))
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def sample(self):
        folder = f"/proc/{self.server.process.pid}"
        text = self.server.get("/metrics")[2].decode()

        def metric(name):
            found = re.search(rf"(?m)^{name} (\S+)$", text)
            return float(found.group(1)) if found else 0
        return {"rss": self.server.resident(), "files": len(os.listdir(folder + "/fd")), "threads": len(os.listdir(folder + "/task")),
                "heap": metric("scancast_process_heap_bytes"), "sessions": metric("scancast_sessions"), "lines": metric('scancast_request_log_lines_total{outcome="written"}')}

    def run(self):
        before = time.monotonic(), self.server.cpu_seconds()
        while not self.done.wait(1):
            try:
                now = time.monotonic(), self.server.cpu_seconds()
                share = (now[1] - before[1]) / (now[0] - before[0]) / self.cores
                before = now
                self.load.adjust(share)
                self.samples.append({**self.sample(), "share": share})
                ready = self.server.get("/readyz")[0]
                if ready != 200:
                    self.faults.append(f"/readyz was {ready}")
            except (OSError, ValueError) as error:
                if not self.done.is_set():
                    self.faults.append(f"the server was not there to be looked at: {error!r}")

    def stop(self):
        self.done.set()
        self.thread.join(10)

    def growth(self, what):
        """From the first third of the samples to the last: medians, since sessions come and go."""
        values = [sample[what] for sample in self.samples]
        third = max(1, len(values) // 3)
        return statistics.median(values[:third]), statistics.median(values[-third:])

    def verdict(self):
        found = list(dict.fromkeys(self.faults))
        most = max(sample["rss"] for sample in self.samples)
        if most > MEMORY_LIMIT * 1.25:
            found.append(f"{most >> 20} MiB of memory, where {MEMORY_LIMIT >> 20} MiB and a quarter are allowed")
        for what, slack in (("files", 12), ("threads", 4)):
            first, last = self.growth(what)
            if last > first * 1.1 + slack:
                found.append(f"{what} grew from {first:.0f} to {last:.0f}")
        return found


def drain(pipe, lines):
    for _ in pipe:
        lines[0] += 1


def make_clouds(scancast, folder, points):
    """The one that is left alone, and two versions of the one that is not; and what is added meanwhile."""
    root = os.path.join(folder, "root")
    os.mkdir(root)
    for scene, name, count in (("town", "still", points), ("room", "first", "100k"), ("statue", "second", "100k")):
        scan = os.path.join(folder, name + ".las")
        for command in (["generate", scene, "--points", count, "-o", scan], ["ingest", scan, "-o", os.path.join(folder, name + ".scan")]):
            subprocess.run([scancast, *command], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    added = [("added.las", "300k")]
    if os.path.exists(os.path.join(os.path.dirname(scancast), "scancast-import-pcl")):
        added.append(("added.ply", "1M"))
    for name, count in added:
        subprocess.run([scancast, "generate", "town", "--points", count, "-o", os.path.join(root, name)], check=True, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    return root


class Soak:
    def __init__(self, options, folder):
        scancast = os.path.abspath(os.path.join(options.bin, "scancast"))
        self.options = options
        root = make_clouds(scancast, folder, options.points)
        versions = [os.path.join(folder, name + ".scan") for name in ("first", "second")]
        served = os.path.join(folder, "moving.scan")
        with open(versions[0], "rb") as source, open(served, "wb") as target:
            target.write(source.read())
        token, cache = secrets.token_urlsafe(32), os.path.join(folder, "cache")
        os.mkdir(cache)
        with open(os.open(os.path.join(folder, "token"), os.O_CREAT | os.O_WRONLY, 0o600), "w") as file:
            file.write(token + "\n")
        self.lines = [0]
        reader, writer = os.pipe()
        threading.Thread(target=drain, args=(os.fdopen(reader, errors="replace"), self.lines), daemon=True).start()
        self.server = serving.Server(scancast, os.path.join(folder, "still.scan"), 64, writer, served, "--memory-limit", str(MEMORY_LIMIT), "--cache-dir", cache,
                                     "--data-root", root, "--admin-token-file", os.path.join(folder, "token"))
        os.close(writer)
        self.server.cloud = "still"
        self.moving = Moving(self.server, "moving", served)
        self.faults = faults.Faults(self.server, self.moving, versions, root, token, options.seed)
        self.done_faults, self.unexpected = collections.Counter(), []
        self.learn()
        self.still = self.picture()

    def learn(self):
        """What the versions of the changing cloud look like, before anything goes wrong."""
        self.moving.learn(0)
        known = dict(self.moving.pictures)
        self.faults.put(1)
        end = time.monotonic() + 30
        while time.monotonic() < end and (shown := self.moving.picture())[2] == known[0] or shown[0] != 200:
            time.sleep(0.3)
        self.moving.learn(1)
        self.faults.put(0)
        if not self.faults.shows(0) or self.moving.pictures[0] == self.moving.pictures[1]:
            raise SystemExit("the changing cloud cannot be changed: nothing to soak with")

    def picture(self):
        return self.server.get(f"/api/v1/clouds/still/snapshot.png?{PICTURE}&method=ewa")[2]

    def misbehave(self, done):
        while not done.wait(self.faults.random.uniform(1, 4)):
            try:
                name, outcome = self.faults.one()
            except (OSError, ValueError) as error:
                name, outcome = "a fault", f"UNEXPECTED: {error!r}"
            self.done_faults[f"{name} ({outcome})" if outcome.startswith("left out") else name] += 1
            if outcome.startswith("UNEXPECTED"):
                self.unexpected.append(f"{name}: {outcome}")

    def run(self):
        load, done = Load(self.server), threading.Event()
        watch = Watch(self.server, load)
        viewer = polite.PoliteViewer(self.server.address, 640, 360)
        time.sleep(3)
        troublemaker = threading.Thread(target=self.misbehave, args=(done,), daemon=True)
        troublemaker.start()
        print("| minute | busy, % | frames | longest gap, ms | median, ms | memory, MiB | heap, MiB | files | threads | sessions | log lines | faults | unexpected |\n"
              "|---|---|---|---|---|---|---|---|---|---|---|---|---|", flush=True)
        gaps, minute, end = [], 0, time.monotonic() + self.options.minutes * 60
        while time.monotonic() < end:
            minute += 1
            start, seen = time.monotonic(), len(watch.samples)
            gap, rate = viewer.measure(min(60, max(5, end - start)))
            gaps.append(gap)
            came = [at for at in list(viewer.arrivals) if at >= start]
            between = [later - earlier for earlier, later in zip(came, came[1:])] or [0]
            if self.picture() != self.still:
                self.unexpected.append(f"minute {minute}: another picture of the cloud that is left alone")
            samples = watch.samples[seen:] or watch.samples[-1:]
            last = samples[-1]
            print(f"| {minute} | {100 * statistics.mean(s['share'] for s in samples):.0f} | {len(came)} | {gap:.0f} | {1000 * statistics.median(between):.0f} | "
                  f"{max(s['rss'] for s in samples) >> 20} | {last['heap'] / (1 << 20):.0f} | {last['files']} | {last['threads']} | {last['sessions']:.0f} | "
                  f"{self.lines[0]} | {sum(self.done_faults.values())} | {len(load.unexpected) + len(self.unexpected) + len(watch.faults)} |", flush=True)
            if self.server.process.poll() is not None:
                raise SystemExit(f"the server ended with {self.server.process.returncode}")
        done.set()
        troublemaker.join(120)
        viewer.stop()
        load.stop()
        watch.stop()
        self.faults.close()
        return self.verdict(load, watch, viewer, gaps)

    def verdict(self, load, watch, viewer, gaps):
        found = watch.verdict() + load.unexpected + self.unexpected + self.moving.wrong
        if viewer.failure:
            found.append(f"the polite viewer: {viewer.failure}")
        if max(gaps) > self.options.gap:
            found.append(f"the polite viewer waited {max(gaps):.0f} ms for a frame")
        ended = self.server.stop()
        if ended != 0:
            found.append(f"the server ended with {ended}")
        print("answers:", ", ".join(f"{count} {what}" for what, count in sorted(load.answers.items(), key=str)))
        print("faults:", ", ".join(f"{count} {what}" for what, count in sorted(self.done_faults.items())))
        for line in found[:40]:
            print("WRONG: " + line)
        print("held" if not found else f"{len(found)} things were wrong")
        return 1 if found else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="where scancast is")
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--points", default="2M", help="of the cloud that is left alone")
    parser.add_argument("--gap", type=float, default=500, help="ms that the polite viewer may wait for a frame")
    parser.add_argument("--seed", type=int, default=1, help="of the order of faults")
    options = parser.parse_args()
    serving.allow_many_files()
    with tempfile.TemporaryDirectory() as folder:
        return Soak(options, folder).run()


if __name__ == "__main__":
    sys.exit(main())
