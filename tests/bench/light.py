#!/usr/bin/python3
"""How bright Phong's light leaves photographed colours.

    tests/bench/light.py [--scancast build/release/bin/scancast] [--data ../shared/data] [--scans NAME,FILE...]
                         [--method ewa] [--backend cpu] [--most-views 6] [--light NAME=VALUE ...] [--limit 5]

Draws every scan that has colours from all views that its look names, twice: unlit and lit, both at one sample a pixel
before nothing. Of both, the mean luminance (Rec. 709's weights of the picture's own values, 0 - 255) of the pixels that
show something, which are the same ones. Prints a Markdown row for each scan: the means over its views, their ratio, the
view that differs most. Ends with 1 where a scan's ratio is further than --limit percent from 1 (docs/spec/shading.md,
section 2), with 2 where nothing could be measured. Scans that are not there, or that cannot be read, are skipped, loudly.
"""
import argparse
import http.client
import json
import os
import re
import subprocess
import sys
import tempfile
import time

import png_file

SCANS = ["ply/guanyin-statue.ply", "laz/strand-statue-1m.laz", "copc/lion_takanawa.copc.laz", "pcd/milk_color.pcd",
         "pcd/office1.pcd", "pcd/table_scene_mug_stereo_textured.pcd", "las/autzen_trim.las", "las/sample_c.las",
         "laz/ign-lidarhd-fields.laz", "las/warsaw_small.las", "town", "room"]
GENERATED_POINTS = "500k"
PATIENCE = 300  # seconds
WEIGHTS = (0.2126, 0.7152, 0.0722)


class Server:
    def __init__(self, scancast, scan, backend):
        self.process = subprocess.Popen([scancast, "serve", scan, "--port", "0", "--backend", backend, "--log-level", "error"],
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        address = re.search(r"http://([^/]+)", self.process.stdout.readline())
        if not address:
            raise RuntimeError(self.process.communicate()[1].strip().splitlines()[-1])
        self.connection = http.client.HTTPConnection(address.group(1), timeout=PATIENCE)
        deadline = time.monotonic() + PATIENCE
        while time.monotonic() < deadline:
            clouds = json.loads(self.ask("GET", "/api/v1/clouds"))["clouds"]
            if clouds and clouds[0]["state"] == "ready":
                self.cloud = clouds[0]
                return
            if self.process.poll() is not None:
                raise RuntimeError(self.process.stderr.read().strip())
            time.sleep(0.1)
        raise RuntimeError("it is not ready in time")

    def ask(self, verb, path, body=None, kind="application/json"):
        headers = {"Accept": kind} | ({"Content-Type": "application/json"} if body else {})
        self.connection.request(verb, path, json.dumps(body) if body else None, headers)
        answer = self.connection.getresponse()
        data = answer.read()
        if answer.status != 200:
            raise RuntimeError(data.decode(errors="replace"))
        return data

    def views(self):
        path = f"/api/v1/clouds/{self.cloud['id']}/views?width=960&height=540&samples=1&background=transparent&color=rgb"
        return [entry["view"] | {"name": entry["name"]} for entry in json.loads(self.ask("GET", path))["views"]]

    def luminance(self, view):
        """Its sum over all pixels, and how many pixels show something."""
        data = self.ask("POST", f"/api/v1/clouds/{self.cloud['id']}/snapshot", view, "image/png")
        picture = png_file.decoded(data)
        if picture.channels != 4:
            return 0, 0
        shown = picture.channel(3).count(255)
        return sum(w * sum(picture.channel(c)) for c, w in enumerate(WEIGHTS)), shown

    def stop(self):
        self.process.terminate()
        self.process.wait(PATIENCE)
        self.process.stdout.close()
        self.process.stderr.close()


def light_of(words):
    light = {}
    for word in words:
        name, _, value = word.partition("=")
        numbers = [float(part) for part in value.split(",")]
        light[name] = numbers if len(numbers) > 1 else numbers[0]
    return light


def measured(server, options):
    """Name, means and ratio of each view."""
    rows = []
    for view in server.views()[: options.most_views]:
        name = view.pop("name")
        style = {"method": options.method, "param": {}}
        dark, shown = server.luminance(view | style | {"shading": "unlit"})
        light = {"light": light_of(options.light)} if options.light else {}
        lit, still = server.luminance(view | style | {"shading": "phong"} | light)
        if shown != still:
            raise RuntimeError(f"{name}: light changes which pixels show something")
        if shown > 0 and dark > 0:
            rows.append((name, dark / shown, lit / shown, lit / dark))
    return rows


def scan_file(name, options, folder):
    if name in ("town", "room"):
        path = os.path.join(folder, name + ".las")
        subprocess.run([options.scancast, "generate", name, "--points", GENERATED_POINTS, "-o", path], check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return path
    return name if os.path.exists(name) else os.path.join(options.data, name)


def main():
    here = os.path.dirname(os.path.abspath(__file__))
    root = os.path.dirname(os.path.dirname(here))
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scancast", default=os.path.join(root, "build/release/bin/scancast"))
    parser.add_argument("--data", default=os.path.join(root, "../shared/data"))
    parser.add_argument("--scans", default=",".join(SCANS))
    parser.add_argument("--method", default="ewa")
    parser.add_argument("--backend", default="cpu")
    parser.add_argument("--most-views", type=int, default=6)
    parser.add_argument("--light", action="append", default=[])
    parser.add_argument("--limit", type=float, default=5)
    options = parser.parse_args()
    print("| scan | views | unlit | lit | lit / unlit | furthest view |\n|---|--:|--:|--:|--:|---|")
    measured_any, beyond = False, False
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scans.split(","):
            try:
                server = Server(options.scancast, scan_file(name, options, folder), options.backend)
            except (RuntimeError, OSError, IndexError) as problem:
                print(f"{name}: skipped: {problem}", file=sys.stderr)
                continue
            try:
                rows = measured(server, options)
            except RuntimeError as problem:
                print(f"{name}: skipped: {problem}", file=sys.stderr)
                continue
            finally:
                server.stop()
            if not rows:
                continue
            unlit, lit = (sum(row[at] for row in rows) / len(rows) for at in (1, 2))
            furthest = max(rows, key=lambda row: abs(row[3] - 1))
            print(f"| {name} | {len(rows)} | {unlit:.1f} | {lit:.1f} | {lit / unlit:.3f} | {furthest[0]}: {furthest[3]:.3f} |",
                  flush=True)
            measured_any = True
            beyond = beyond or abs(lit / unlit - 1) > options.limit / 100
    return 1 if beyond else 0 if measured_any else 2


if __name__ == "__main__":
    sys.exit(main())
