"""What a benchmark tells a program that reads it, beside what it prints: --json FILE, of one form for all of them (tests/load/load.py has it, too).

    {"figures": [{"name": "…", "value": 5.3, "unit": "ms", "low": 5.1, "high": 5.6, …}, …]}

`low` and `high` are of the rounds whose median is `value`. Whatever else a row has is the benchmark's own.
"""
import json


class Told:
    def __init__(self):
        self.rows = []

    def figure(self, name, value, unit="", **more):
        self.rows.append({"name": name, "value": value, "unit": unit, **{key: it for key, it in more.items() if it is not None}})

    def write(self, path):
        """Nowhere where there is no path."""
        if path:
            with open(path, "w", encoding="utf-8") as file:
                json.dump({"figures": self.rows}, file, indent=1)


def add_option(parser):
    parser.add_argument("--json", metavar="FILE", help="write the figures there, too (tests/bench/figures/told.py)")
