"""deploy/monitoring/ asks for metrics that the server has, in words that Prometheus understands, and rules wake people when, and
only when, something is wrong (alerts_test.yml).

    monitoring_test.py
"""
import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
RULES = os.path.join(ROOT, "deploy", "monitoring", "alerts.yml")
HISTOGRAM = ("_bucket", "_sum", "_count")
# What Grafana puts in before it asks.
VARIABLES = {"$__rate_interval": "5m", "$job": "scancast", "$instance": ".*"}


def text_of(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


def metrics():
    """Of the server: name and kind."""
    found = re.findall(r'Build(Counter|Gauge|Histogram)\(\)\s*\.Name\("(\w+)"\)', text_of("server", "base", "metrics.cpp"))
    return {name: kind for kind, name in found}


def promtool(*arguments):
    tool = shutil.which("promtool")
    if not tool:
        print("\nSKIPPED: rules and expressions are not read by promtool, which is not installed (Debian: prometheus)", flush=True)
        raise unittest.SkipTest("promtool is not installed")
    done = subprocess.run([tool, *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
    if done.returncode:
        raise AssertionError(f"promtool {' '.join(arguments)} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


class Monitoring(unittest.TestCase):
    known = metrics()
    dashboard = json.loads(text_of("deploy", "monitoring", "dashboard.json"))
    asked = [(panel["title"], target["expr"]) for panel in dashboard["panels"] for target in panel["targets"]]
    # An expression reaches from "expr:" to the next key.
    alerts = re.findall(r"- alert: (\w+)\n\s+expr: (.*?)\n\s+(?:for|labels):", text_of("deploy", "monitoring", "alerts.yml"), re.S)

    def test_every_metric_is_one_that_the_server_has_and_is_asked_as_its_kind_is(self):
        self.assertGreater(len(self.known), 20)
        named = set()
        for where, expression in self.asked + self.alerts:
            for name in re.findall(r"\bscancast_\w+", expression):
                base = next((name[:-len(end)] for end in HISTOGRAM if name.endswith(end) and name[:-len(end)] in self.known), name)
                named.add(base)
                self.assertIn(base, self.known, where)
                self.assertEqual(base != name, self.known[base] == "Histogram", f"{where}: {name}")
                if self.known[base] != "Gauge":
                    self.assertRegex(expression, rf"(rate|increase)\({name}\b", where)
                else:
                    self.assertNotRegex(expression, rf"(rate|increase)\({name}\b", where)
        self.assertEqual(set(self.known) - named, set(), "what the server tells is shown, or wakes somebody")

    def test_every_value_of_a_label_is_one_that_the_server_gives(self):
        given = set(re.findall(r'return "(\w+)";', text_of("server", "base", "metrics.cpp"))) | {"500"}
        for where, expression in self.alerts:
            for label, value in re.findall(r'(\w+)!?="(\w+)"', expression):
                self.assertIn(value, given if label != "job" else {"scancast"}, where)

    def test_the_dashboard_is_whole(self):
        panels = self.dashboard["panels"]
        self.assertGreaterEqual(len(panels), 12)
        self.assertEqual(len({panel["id"] for panel in panels}), len(panels))
        self.assertEqual(len({panel["title"] for panel in panels}), len(panels))
        squares = [(x, y) for panel in panels for place in (panel["gridPos"],)
                   for x in range(place["x"], place["x"] + place["w"]) for y in range(place["y"], place["y"] + place["h"])]
        self.assertEqual(len(set(squares)), len(squares), "no panel lies on another")
        self.assertLess(max(x for x, _ in squares), 24)
        variables = {"$" + variable["name"] for variable in self.dashboard["templating"]["list"]}
        for panel in panels:
            self.assertTrue(panel["description"], panel["title"])
            self.assertEqual(panel["datasource"]["uid"], "${source}", panel["title"])
            for target in panel["targets"]:
                for name in re.findall(r"\$\w+", target["expr"]):
                    self.assertIn(name, variables | {"$__rate_interval"}, panel["title"])

    def test_every_alert_says_what_it_means_and_what_to_do(self):
        blocks = text_of("deploy", "monitoring", "alerts.yml").split("- alert: ")[1:]
        self.assertEqual(len(blocks), len(self.alerts))
        for block in blocks:
            for key in ("severity: ", "summary: ", "description: "):
                self.assertEqual(block.count(key), 1, block.split("\n")[0])

    def test_promtool_takes_the_rules(self):
        self.assertIn(f"{len(self.alerts)} rules found", promtool("check", "rules", RULES))

    def test_promtool_takes_what_the_dashboard_asks(self):
        rules = []
        for number, (_, expression) in enumerate(self.asked):
            for name, value in VARIABLES.items():
                expression = expression.replace(name, value)
            rules.append({"record": f"panel:{number}", "expr": expression})
        with tempfile.NamedTemporaryFile("w", suffix=".yml") as file:
            json.dump({"groups": [{"name": "dashboard", "rules": rules}]}, file)  # JSON is YAML
            file.flush()
            self.assertIn(f"{len(rules)} rules found", promtool("check", "rules", file.name))

    def test_rules_wake_people_when_something_is_wrong_and_only_then(self):
        promtool("test", "rules", os.path.join(HERE, "alerts_test.yml"))
        for name, _ in self.alerts:
            self.assertIn(f'"{name}"', text_of("tests", "deploy", "alerts_test.yml"))


if __name__ == "__main__":
    unittest.main()
