#!/usr/bin/python3
"""Streams and snapshots under load: what was promised, what is reached.

    tests/load/load.py [--bin build/release/bin] [--points 20M] [--file town.scan] [--only moving,idle,…] [--json FILE]
    tests/load/load.py --points 1M --quick      # a minute, to see that everything runs; the figures mean nothing

Serves a generated town and prints every figure with its mark, "reached" or "missed". Ends with 0 when everything could be
measured - whatever was missed - and nothing failed. README.md says what each part does.
"""
import argparse
import concurrent.futures
import json
import os
import random
import statistics
import subprocess
import tempfile
import threading
import time

import serving

MB = 1e6


class Sheet:
    """Prints figures as they come, and keeps them."""

    def __init__(self):
        self.rows, self.failures, self.title = [], [], ""

    def part(self, title):
        self.title = title
        print(f"\n{title}", flush=True)

    def figure(self, name, value, unit="", most=None, least=None, digits=1):
        """A number with the mark that it must not exceed, or fall below; without a mark it only informs."""
        mark = most if most is not None else least
        reached = None if mark is None else value <= most if most is not None else value >= least
        self.rows.append({"part": self.title, "name": name, "value": value, "unit": unit, "most": most, "least": least, "reached": reached})
        verdict = "" if mark is None else f"   {'<=' if most is not None else '>='} {mark:g}: {'reached' if reached else 'MISSED'}"
        print(f"  {name:<66} {value:>10.{digits}f} {unit:<9}{verdict}", flush=True)

    def promise(self, name, kept):
        """What must hold on any machine, in any time."""
        print(f"  {name:<66} {'yes' if kept else 'NO':>10}", flush=True)
        self.rows.append({"part": self.title, "name": name, "value": bool(kept), "reached": bool(kept)})
        if not kept:
            self.failures.append(name)

    def sound(self, groups):
        for behaviour, group in groups.items():
            if group["failed"]:
                self.failures.append(f"{group['failed']} {behaviour} sessions failed: {'; '.join(group['errors'])}")
                print(f"  FAILED: {self.failures[-1]}", flush=True)


class Load:
    def __init__(self, client, server, sheet, quick):
        self.client, self.server, self.sheet, self.quick = client, server, sheet, quick
        self.seconds = 1 if quick else 15

    def bench(self, *flags, url=None, size=(1280, 720)):
        groups, sampler = serving.bench(self.client, self.server, *flags, "--width", size[0], "--height", size[1], url=url)
        self.sheet.sound(groups)
        return groups, sampler

    def frames(self, group):
        """How good the frames were: the floors of the protocol."""
        figure = self.sheet.figure
        for key, name, unit, floor in (("resolution", "resolution", "of full", {"least": 0.5}),
                                       ("jpegQuality", "JPEG quality", "", {"least": 40}),
                                       ("detail", "detail", "px", {"most": 2})):
            values = group[key]
            if values:
                worst = values["max"] if "most" in floor else values["min"]
                figure(f"{name} of moving frames: median", values["p50"], unit, digits=2)
                figure(f"{name} of moving frames: worst", worst, unit, digits=2, **floor)
        print(f"  chroma of moving frames: {group['subsampling']}")

    def moving(self):
        self.sheet.part("One client moving, loopback")
        self.bench("--moving", 1, "--seconds", self.seconds)  # what the walk shows is read once, for everybody
        before = self.server.resident()
        groups, sampler = self.bench("--moving", 1, "--seconds", self.seconds)
        group, figure = groups["moving"], self.sheet.figure
        if not group["latencyMs"]:
            return self.sheet.failures.append("no moving frame came")
        figure("view to its frame: median", group["latencyMs"]["p50"], "ms", most=25)
        figure("view to its frame: p99", group["latencyMs"]["p99"], "ms", most=60)
        figure("frames a second", group["framesPerSecond"]["p50"], "", least=30)
        figure("memory of the session", (max(size for _, size in sampler.during) - before) / MB, "MB", most=20)
        self.frames(group)

    def crowd(self):
        clients = 3 if self.quick else 8
        rounds = 1 if self.quick else 3
        beside = ("--slow", 1, "--slow-bytes", 50000, "--never-ack", 1)
        before = self.server.resident()
        # In turn: what a machine does between two runs is not what the slow ones cost.
        alone, among = [], []
        for _ in range(rounds):
            alone.append(self.bench("--moving", clients, "--seconds", self.seconds))
            among.append(self.bench("--moving", clients, *beside, "--seconds", self.seconds))

        def rates(runs, behaviour, key):
            return [groups[behaviour]["framesPerSecond"][key] for groups, _ in runs]

        figure = self.sheet.figure
        self.sheet.part(f"{clients} clients moving" + (f"; medians of {rounds} runs" if rounds > 1 else ""))
        each = statistics.median(rates(alone, "moving", "p50"))
        slowest = statistics.median(rates(alone, "moving", "min"))
        figure("frames a second of each: median", each)
        figure("frames a second of each: slowest", slowest, least=8)
        figure("slowest over median", slowest / each if each else 0, least=0.5, digits=2)
        peak = max(size for _, size in alone[0][1].during)
        figure("memory of each session", (peak - before) / clients / MB, "MB", most=20)
        self.frames(alone[-1][0]["moving"])

        self.sheet.part("The same with one that reads 50 kB/s and one that never acknowledges, in turn with these")
        others = statistics.median(rates(among, "moving", "p50"))
        figure("frames a second of the others: median", others)
        losses = [1 - with_them / without for with_them, without in
                  zip(rates(among, "moving", "p50"), rates(alone, "moving", "p50")) if without]
        figure("what the others lose", 100 * statistics.median(losses) if losses else 100, "%", most=5)
        figure("growth of the server's memory meanwhile", 100 * max(sampler.growth() for _, sampler in among), "%", most=2)
        figure("frames a second of the slow one", statistics.median(rates(among, "slow", "p50")))
        self.frames(among[-1][0]["moving"])

    def idle(self):
        sessions = 20 if self.quick else 500
        self.sheet.part(f"{sessions} idle sessions, their final stills sent; then all move once")
        before = self.server.resident()
        groups, sampler = self.bench("--idle", sessions, "--warm-up", 1, "--seconds", self.seconds, "--wake", self.seconds + 2)
        figure, group = self.sheet.figure, groups["idle"]
        figure("processor time while idle", 100 * sampler.cpu_share(), "%", most=1, digits=2)
        figure("memory of each session", (sampler.during[-1][1] - before) / sessions / MB, "MB", most=20, digits=2)
        self.sheet.promise("nothing is sent after the final still", group["idleFrames"] == 0)
        figure("all move once: answered, median", group["answerMs"]["p50"] / 1000, "s", digits=2)
        figure("all move once: answered, the last one", group["answerMs"]["max"] / 1000, "s", most=8, digits=2)
        figure("sessions with a second frame before all had their first", group["secondBeforeAll"], most=0, digits=0)

    def timed(self, paths, headers=None, expect=200):
        milliseconds = []
        connection = self.server.connect()
        for path in paths:
            start = time.perf_counter()
            status, _, _ = self.server.get(path, connection, headers=headers)
            milliseconds.append((time.perf_counter() - start) * 1000)
            if status != expect:
                self.sheet.failures.append(f"GET {path} answered {status}, not {expect}")
        connection.close()
        return statistics.median(milliseconds)

    def views(self, count, more):
        """Queries of pictures that nobody has asked for before."""
        view = json.loads(self.server.get(f"/api/v1/clouds/{self.server.cloud}")[2])["view"]["camera"]
        for _ in range(count):
            x, y, z = (value + random.uniform(-2, 2) for value in view["eye"])
            yield self.server.snapshot(f"width=1280&height=720&eye={x:.6f},{y:.6f},{z:.6f}&{more}")

    def snapshots(self):
        self.sheet.part("Snapshots, 1280 x 720")
        path = self.server.snapshot("width=1280&height=720")
        etag = self.server.get(path)[1].get("ETag", "")
        count, figure = (5 if self.quick else 30), self.sheet.figure
        figure("304: median", self.timed([path] * 10 * count, {"If-None-Match": etag}, 304), "ms", most=1, digits=2)
        figure("uncached, samples=1: median", self.timed(self.views(count, "samples=1")), "ms", most=60)
        figure("uncached, samples=4 (the default): median", self.timed(self.views(count, "")), "ms", most=180)
        self.mixed(path, etag)

    def mixed(self, path, etag):
        requests = 50
        views = list(self.views(requests, "samples=1"))
        kinds = [(lambda i: (path, {"If-None-Match": etag})), (lambda i: (path, {})), (lambda i: (views[i], {})),
                 (lambda i: (views[i].replace(".jpg", ".png"), {})), (lambda i: (views[i].replace("samples=1", "samples=4"), {}))]

        def ask(i):
            target, headers = kinds[i % len(kinds)](i)
            status, answer, _ = self.server.get(target, headers=headers)
            return status, "Retry-After" in answer

        start = time.perf_counter()
        with concurrent.futures.ThreadPoolExecutor(requests) as pool:
            answers = list(pool.map(ask, range(requests)))
        honest = all(status in (200, 304) or (status == 503 and retry) for status, retry in answers)
        busy = sum(status == 503 for status, _ in answers)
        self.sheet.promise(f"{requests} at once: pictures, 304, or 503 with Retry-After ({busy} of these)", honest)
        self.sheet.figure(f"{requests} at once: all answered after", time.perf_counter() - start, "s", digits=2)

    def followers(self):
        """One is driven by HTTP; others follow it, in the same size, and read all that they are sent."""
        count = 20 if self.quick else 200
        self.sheet.part(f"One session of 640 x 360 that is moved 30 times a second, and {count} that follow it")
        leader = serving.MjpegReaders(self.server)
        leader.open("width=640&height=360")
        leader.read(0.5)
        readers = serving.MjpegReaders(self.server)
        for _ in range(count):
            readers.open(f"session={leader.session()}&width=640&height=360")
        readers.read(3)  # each begins with a picture of its own
        over = threading.Event()
        threads = [threading.Thread(target=lambda: self.drive(leader.session(), over)),
                   threading.Thread(target=lambda: leader.read_until(over))]
        for thread in threads:
            thread.start()
        readers.read(1)
        before, frames = serving.metrics(self.server), list(readers.counts)
        readers.read(self.seconds)
        after, seen = serving.metrics(self.server), list(readers.counts)
        over.set()
        for thread in threads:
            thread.join()
        leader.close()
        readers.close()

        def more(name):
            return after.get(name, 0) - before.get(name, 0)

        figure = self.sheet.figure
        followed = [now - then for now, then in zip(seen, frames)]
        figure("frames a second of each follower: median", statistics.median(followed) / self.seconds)
        figure("frames a second of each follower: least", min(followed) / self.seconds)
        encoded = more("scancast_frame_encode_seconds_count")
        figure("encoded, over frames of a follower", encoded / (statistics.median(followed) or 1), most=1.2, digits=2)
        figure("frames that were shared", 100 * more("scancast_frames_shared_total") / (more("scancast_frames_sent_total") or 1), "%")

    def messages(self):
        """What a view costs that is overwritten before it is drawn: nobody acknowledges, so that nothing is drawn beside it."""
        count = 2000 if self.quick else 20_000
        self.sheet.part(f"{count} views in one stream, 320 x 180, of which none is acknowledged")
        view = json.loads(self.server.get(f"/api/v1/clouds/{self.server.cloud}")[2])["view"]
        whole = {"type": "view", **{key: value for key, value in view.items() if key not in ("cloud", "width", "height")}}
        for name, message in (("a camera", {"type": "view", "camera": view["camera"]}), ("a whole view", whole)):
            stream = serving.Stream(self.server)
            stream.send({"type": "hello", "cloud": self.server.cloud, "width": 320, "height": 180})
            stream.read(1)
            eye, seq = message["camera"]["eye"], 0

            def views(many):
                nonlocal seq
                for _ in range(many):
                    seq += 1
                    moved = {**message["camera"], "eye": [eye[0] + seq * 1e-4, *eye[1:]]}
                    yield {**message, "seq": seq, "camera": moved}

            for _ in range(40):  # until as many frames are on their way as may be
                stream.send(*views(5))
                stream.read(0.05)
            before = serving.metrics(self.server), self.server.cpu_seconds()
            for _ in range(20):
                stream.send(*views(count // 20))
            stream.send({"type": "ping", "id": 1})
            stream.read(0.5)
            after = serving.metrics(self.server), self.server.cpu_seconds()
            drawn = [numbers.get("scancast_frames_sent_total", 0) for numbers, _ in (before, after)]
            stream.close()
            self.sheet.figure(f"{name}: processor time of the server", (after[1] - before[1]) / count * 1e6, "us", most=40)
            self.sheet.figure(f"{name}: frames that were sent meanwhile", drawn[1] - drawn[0], digits=0)

    def drive(self, session, over):
        """A walk around, until it is over."""
        view = json.loads(self.server.get(f"/api/v1/clouds/{self.server.cloud}")[2])["view"]["camera"]
        connection, step = self.server.connect(), 0
        while not over.wait(1 / 30):
            step += 1
            eye = [view["eye"][0] + step * 0.02, view["eye"][1], view["eye"][2]]
            status, _, answer = self.server.get(f"/api/v1/sessions/{session}/view", connection, "POST", json.dumps({"camera": {"eye": eye}}),
                                                {"Content-Type": "application/json"})
            if status != 200:
                self.sheet.failures.append(f"a session could not be driven: {answer[:200].decode(errors='replace')}")
                return
        connection.close()

    def shaped(self):
        for delay, words in ((50, "100 ms there and back"), (100, "100 ms each way")):
            self.through_line(delay, words)

    def through_line(self, delay, words):
        self.sheet.part(f"Through 2 Mbit/s, {words}, 640 x 360")
        proxy = serving.Proxy(self.server, 2000, delay)
        try:
            with tempfile.TemporaryDirectory() as folder:
                final = os.path.join(folder, "final.jpg")
                groups, _ = self.bench("--moving", 1, "--views", 30, "--warm-up", 3, "--seconds", self.seconds, "--final", final,
                                       url=proxy.url, size=(640, 360))
                group, figure = groups["moving"], self.sheet.figure
                figure("frames a second", group["framesPerSecond"]["p50"], least=10)
                if group["latencyMs"]:
                    figure("view to its frame: median", group["latencyMs"]["p50"], "ms", most=400)
                    figure("view to its frame: p99", group["latencyMs"]["p99"], "ms")
                    self.frames(group)
                if group["finalMs"]:
                    self.final(final, group["finalMs"]["p50"] / 1000)
        finally:
            proxy.stop()

    def final(self, path, seconds):
        with open(path, "rb") as file:
            picture = file.read()
        with open(path + ".json") as file:
            view = file.read()
        self.sheet.figure("final still, over the time of its bytes on the line", seconds - len(picture) / 250_000, "s", most=0.5,
                          digits=2)
        status, _, same = self.server.get(f"/api/v1/clouds/{self.server.cloud}/snapshot", method="POST", body=view,
                                          headers={"Content-Type": "application/json", "Accept": "image/jpeg"})
        if status != 200:
            self.sheet.failures.append(f"POST snapshot answered {status}: {same[:200].decode(errors='replace')}")
        self.sheet.promise("final still is the snapshot of its view, byte for byte", same == picture)


PARTS = ("moving", "crowd", "followers", "messages", "idle", "snapshots", "shaped")


def cloud_file(scancast, arguments, folder):
    if arguments.file:
        return arguments.file
    las, scan = os.path.join(folder, "town.las"), os.path.join(folder, "town.scan")
    subprocess.run([scancast, "generate", "town", "--points", arguments.points, "-o", las, "--quiet"], check=True)
    subprocess.run([scancast, "ingest", las, "-o", scan], check=True, stderr=subprocess.DEVNULL)
    os.remove(las)
    return scan


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    parser.add_argument("--bin", default=os.path.join(root, "build/release/bin"), help="folder of the programs")
    parser.add_argument("--points", default="20M", help="of the town")
    parser.add_argument("--file", help="a scan or cloud file instead of the town")
    parser.add_argument("--only", default=",".join(PARTS), help="some of " + ",".join(PARTS))
    parser.add_argument("--quick", action="store_true", help="few sessions for a short time")
    parser.add_argument("--json", help="write the figures there, too")
    arguments = parser.parse_args()
    parts = arguments.only.split(",")
    if unknown := set(parts) - set(PARTS):
        parser.error(f"--only knows {','.join(PARTS)}, not {','.join(sorted(unknown))}")
    scancast, client = (os.path.join(arguments.bin, name) for name in ("scancast", "scancast-client"))
    serving.allow_many_files()
    sheet = Sheet()
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "log"), "w+") as log:
        server = serving.Server(scancast, cloud_file(scancast, arguments, folder), 600, log)
        try:
            load = Load(client, server, sheet, arguments.quick)
            load.timed(load.views(3, ""))  # blocks read, threads started
            for part in parts:
                getattr(load, part)()
        finally:
            code = server.stop()
        sheet.part("Afterwards")
        sheet.promise("the server ended gracefully", code == 0)
    missed = [row["name"] for row in sheet.rows if row["reached"] is False]
    judged = [row for row in sheet.rows if row["reached"] is not None]
    print(f"\n{len(judged) - len(missed)} of {len(judged)} marks reached, on {os.cpu_count()} cores")
    if arguments.json:
        with open(arguments.json, "w") as file:
            json.dump({"figures": sheet.rows, "failures": sheet.failures}, file, indent=2)
    if sheet.failures:
        raise SystemExit("failed: " + "; ".join(sheet.failures))


if __name__ == "__main__":
    main()
