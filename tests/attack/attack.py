#!/usr/bin/env python3
"""Attacks a server, and looks how a polite viewer beside fares.

    tests/attack/attack.py [--bin build/release/bin] [--seconds 12] [--points 2M] [--load NAME] [--short]

Generates a cloud, serves it, sends six hundred malformed requests and WebSocket sessions, each of which must be answered as it
deserves; then runs load after load of what is valid and costs much (loads.py), and beside each a viewer who moves a camera over pictures
of 960 x 540. Prints a table: his longest gap between two frames, his rate, that of one among as many like him, the server's memory. After each
load everything must be as before: sessions and pictures that are waited for, the bytes of a picture, /readyz.

Ends with 1 when a request was answered wrongly, when the longest gap is more than 500 ms, the rate less than half of that among as many, or
memory more than the limit and a quarter, or the log longer than floods may make it. --short is for test runs: loads of a second, of which gap and rate are printed and not judged.
"""
import argparse
import os
import re
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "load"))
import serving  # noqa: E402

import loads  # noqa: E402
import malformed  # noqa: E402
import polite  # noqa: E402

LONGEST_GAP = 500  # ms
MEMORY_LIMIT = 512 << 20
LINES_A_MINUTE = 6000 + 21  # and that so many more were left out: server/net/log/repeats.hpp


def metric(server, name):
    found = re.search(rf"(?m)^{re.escape(name)} (\S+)$", server.get("/metrics")[2].decode())
    return float(found.group(1)) if found else 0


def state(server):
    """What must be the same before and after."""
    return {"picture": server.get(server.snapshot("width=320&height=200"))[2], "ready": server.get("/readyz")[0],
            "sessions": metric(server, "scancast_sessions"), "awaited": metric(server, "scancast_pictures_awaited")}


def settles(server, before, patience=20):
    """What has not come back to what it was, by name."""
    end = time.monotonic() + patience
    while True:
        now = state(server)
        different = [name for name in before if now[name] != before[name]]
        if not different or time.monotonic() > end:
            return different
        time.sleep(0.2)


def send_malformed(server, print_all):
    wrong, sent = [], 0
    for case in malformed.http_cases(server.cloud):
        sent += 1
        if why := malformed.answer(server.address, case):
            wrong.append(f"{case.family}: {case.name}: {why}")
    for greeted in (False, True):
        for name, act in malformed.socket_cases():
            sent += 1
            if why := malformed.bother(server.address, act, greeted):
                wrong.append(f"WebSocket{' after hello' if greeted else ''}: {name}: {why}")
    print(f"{sent} malformed requests and sessions, {len(wrong)} of them answered wrongly", flush=True)
    for line in wrong if print_all else wrong[:20]:
        print("  " + line)
    return sent >= 600 and not wrong


def log_is_short(server, seconds, flooded):
    """Whether the lines that all of this has left in the log are as few as they shall be, however many asked."""
    written, repeated = (int(metric(server, f'scancast_request_log_lines_total{{outcome="{outcome}"}}')) for outcome in ("written", "repeated"))
    most = LINES_A_MINUTE * (int(seconds) // 60 + 2)
    print(f"the log has {written} lines of requests and streams, and counts of {repeated} more; {most} lines were allowed")
    return written <= most and (repeated > 0 or not flooded)


class Battery:
    def __init__(self, server, seconds, judged):
        self.server, self.seconds, self.judged, self.good, self.among = server, seconds, judged, True, {}

    def rate_among(self, viewers):
        """Frames a second of one polite viewer among so many."""
        if viewers not in self.among:
            crowd = [polite.PoliteViewer(self.server.address) for _ in range(viewers)]
            time.sleep(1)
            self.among[viewers] = crowd[0].measure(min(self.seconds, 8))[1]
            for viewer in crowd:
                viewer.stop()
        return self.among[viewers]

    def run(self, name):
        clients, act, _ = loads.ALL[name]
        among = self.rate_among(clients + 1) if self.judged else 0
        before = state(self.server)
        viewer = polite.PoliteViewer(self.server.address)
        time.sleep(1)
        load = loads.Load(self.server, clients, act)
        time.sleep(0.3)
        gap, rate = viewer.measure(self.seconds)
        memory = self.server.resident()
        outcomes = load.stop()
        viewer.stop()
        left = settles(self.server, before)
        faults = [f"after it, differs: {', '.join(left)}"] if left else []
        if viewer.failure:
            faults.append(f"the viewer: {viewer.failure}")
        if self.judged and gap > LONGEST_GAP:
            faults.append("the gap is too long")
        if self.judged and rate < among / 2:
            faults.append("the rate is too low")
        if memory > MEMORY_LIMIT * 1.25:
            faults.append("too much memory")
        if self.server.process.poll() is not None:
            raise SystemExit(f"the server ended during '{name}'")
        self.good = self.good and not faults
        print(f"| {name} | {clients} | {gap:.0f} | {rate:.1f} | {f'{among:.1f}' if among else ''} | {memory / (1 << 20):.0f} | "
              f"{'; '.join(faults) or 'held'} | {outcomes} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", default="build/release/bin", help="where scancast is")
    parser.add_argument("--points", default="2M")
    parser.add_argument("--seconds", type=float, default=12, help="of each load")
    parser.add_argument("--load", action="append", choices=list(loads.ALL), help="only this one; may be repeated")
    parser.add_argument("--short", action="store_true", help="for test runs")
    options = parser.parse_args()
    serving.allow_many_files()
    scancast = os.path.join(options.bin, "scancast")
    with tempfile.TemporaryDirectory() as folder, open(os.path.join(folder, "log"), "w+") as log:
        scan, cloud = os.path.join(folder, "town.las"), os.path.join(folder, "town.scan")
        for command in (["generate", "town", "--points", options.points, "-o", scan], ["ingest", scan, "-o", cloud]):
            subprocess.run([scancast, *command], check=True, stderr=log, stdout=log)
        server = serving.Server(scancast, cloud, 64, log, "--memory-limit", str(MEMORY_LIMIT))
        good, began = True, time.monotonic()
        if not options.load:
            good = send_malformed(server, not options.short)
        print("| load | clients | longest gap, ms | frames/s | among as many, /s | memory, MiB | | what they got |\n|---|---|---|---|---|---|---|---|")
        battery = Battery(server, 0.7 if options.short else options.seconds, not options.short)
        for name in options.load or loads.ALL:
            battery.run(name)
        good = log_is_short(server, time.monotonic() - began, not options.load) and good
        ended = server.stop()
        if ended != 0:
            print(f"the server ended with {ended}")
        return 0 if good and battery.good and ended == 0 else 1


if __name__ == "__main__":
    sys.exit(main())
