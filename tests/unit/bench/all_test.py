"""tests/bench/all.py: the registry knows every benchmark, the page every figure, a rewriting leaves nothing of another commit, the gate tells noise
from slowness, plots are XML. With --bin FOLDER, one tiny section from the programs to the page."""
import contextlib
import io
import os
import random
import shutil
import sys
import tempfile
import unittest
import xml.etree.ElementTree

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
BENCH = os.path.join(ROOT, "tests", "bench")
sys.path[:0] = [BENCH, os.path.join(ROOT, "tests", "structure")]
import all as command  # noqa: E402
import tree  # noqa: E402
from figures import gate, machine, page, plot, registry, store, told, words  # noqa: E402
from figures.sections import before, growth, once, pictures  # noqa: E402

BIN = None


def read(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read()


def blocked(**figures):
    return "\n".join(f"<!-- figures: {name} -->\n{text}\n<!-- end of figures: {name} -->" for name, text in figures.items())


class Registry(unittest.TestCase):
    def test_every_script_is_a_figure_or_says_where_its_figures_are(self):
        scripts = {os.path.relpath(os.path.join(folder, name), BENCH) for folder, _, names in os.walk(BENCH) for name in names if name.endswith(".py")}
        scripts = {name for name in scripts if not name.startswith("figures/")}
        self.assertEqual(scripts, registry.HERE | registry.NOT_HERE.keys(), "a new one is a Section of figures/registry.py, or stands in NOT_HERE")
        self.assertFalse(registry.HERE & registry.NOT_HERE.keys())
        for name, place in registry.NOT_HERE.items():
            self.assertTrue(not place.startswith("docs/") or tree.exists(place), f"{name}: {place}")

    def test_every_script_of_a_figure_is_asked_by_a_section(self):
        asked = "".join(read(path) for path in tree.paths() if path.startswith("tests/bench/figures/") and path.endswith(".py") and not path.endswith("registry.py"))
        for name in registry.HERE - {"methods.py"}:
            self.assertIn(f'"{name}"', asked)
        self.assertIn("import methods", asked)

    def test_commands_of_sections_are_there(self):
        for section in registry.SECTIONS:
            for one in section.command.split("; "):
                name = one.split()[0].removeprefix("./")
                self.assertTrue(name.startswith("build/") or os.access(os.path.join(ROOT, name), os.R_OK), one)
        self.assertEqual(len({s.name for s in registry.SECTIONS}), len(registry.SECTIONS))
        self.assertLess(sum(s.minutes for s in registry.SECTIONS if not s.asked), 95)

    def test_names(self):
        self.assertEqual([s.name for s in registry.named(["tau", "vtk"])], ["vtk", "tau"])
        with self.assertRaisesRegex(ValueError, "no figures are called nothing; there are vtk, town"):
            registry.named(["nothing"])


class ThePage(unittest.TestCase):
    TEXT = read("docs/performance.md")

    def test_has_a_place_for_all_figures_and_no_others(self):
        self.assertEqual(set(page.blocks(self.TEXT)), {s.name for s in registry.SECTIONS} | {command.MACHINE})

    def test_has_the_figures_beneath_their_headings(self):
        for section in registry.SECTIONS:
            before_it = self.TEXT[: self.TEXT.index(f"<!-- figures: {section.name} -->")]
            self.assertEqual(page.headings(before_it)[-1], section.heading)

    def test_has_no_figures_of_a_commit_in_its_words(self):
        self.assertEqual(page.COMMIT.findall(page.prose(self.TEXT)), [], "what is of one commit stands between marks, or in docs/measured-once.md")

    def test_a_rewriting_keeps_words_and_anchors_and_nothing_else(self):
        new = page.rewritten(self.TEXT, {name: f"new {name}" for name in page.blocks(self.TEXT)})
        self.assertEqual(page.prose(new), page.prose(self.TEXT))
        self.assertEqual(page.anchors(new), page.anchors(self.TEXT))
        self.assertEqual(page.COMMIT.findall(new), [])
        self.assertEqual(page.rewritten(new, {name: f"new {name}" for name in page.blocks(new)}), new)

    def test_anchors_that_others_link_to(self):
        import re
        links = {m for text in tree.files(".md").values() for m in re.findall(r"performance\.md#([\w-]+)\)", text)}
        self.assertGreater(len(links), 5)
        self.assertLessEqual(links, page.anchors(self.TEXT))


class Rewriting(unittest.TestCase):
    def test_a_row_of_another_commit_is_dropped(self):
        text = "# T\n\nWhy.\n\n" + blocked(a="| x | 5 ms | `0123456` |\n| y | 6 ms | `89abcde` |", b="old") + "\n\nEnd.\n"
        new = page.rewritten(text, {"a": "| x | 4 ms |", "b": "Not measured: no card."})
        self.assertEqual(new, "# T\n\nWhy.\n\n" + blocked(a="| x | 4 ms |", b="Not measured: no card.") + "\n\nEnd.\n")

    def test_refuses_what_does_not_fit(self):
        for text, figures, why in ((blocked(a="1"), {}, "nothing measures: a"), (blocked(a="1"), {"a": "", "b": ""}, "no place for the figures b"),
                                   (blocked(a="1") + "\n" + blocked(a="2"), {"a": ""}, "two blocks"),
                                   ("<!-- figures: a -->\nx\n<!-- end of figures: b -->", {"a": ""}, "without its other half")):
            with self.assertRaisesRegex(ValueError, why):
                page.rewritten(text, figures)

    def test_what_was_kept_of_another_commit_machine_or_size_is_not_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            path, about = os.path.join(folder, "deep", "a.json"), {"commit": {"key": "1"}, "machine": {"cores": 2}}
            store.Store(path, about).put("fast", {"data": 1})
            self.assertEqual(store.Store(path, about).get("fast"), {"data": 1})
            for other in ({**about, "commit": {"key": "2"}}, {**about, "machine": {"cores": 4}}, {**about, "sizes": 1}):
                self.assertIsNone(store.Store(path, other).get("fast"))
            with open(path, "w", encoding="utf-8") as file:
                file.write("{")
            self.assertIsNone(store.Store(path, about).get("fast"))


class Gate(unittest.TestCase):
    def compared(self, new, rounds=gate.ROUNDS, seed=1, noise=0.05):
        chance = random.Random(seed)
        call = lambda true: lambda: true * chance.lognormvariate(0, noise)
        return gate.measured("x", "ms", call(10), call(new), rounds)

    def test_noise_is_not_slowness(self):
        self.assertEqual(gate.judged([self.compared(10, seed=seed) for seed in range(200)]), [])

    def test_slowness_is_seen_through_noise(self):
        slow = [self.compared(12.5, seed=seed) for seed in range(200)]
        self.assertGreater(len(gate.judged(slow)), 195)
        self.assertTrue(all(row.first > gate.LIMIT for row in gate.judged(slow)))  # measured twice

    def test_a_machine_that_gets_slower_meanwhile_is_not_the_build(self):
        hour = iter(range(1000))
        call = lambda: 10 + 2 * next(hour)  # each measurement takes longer than the one before
        self.assertNotEqual(gate.verdict(*(lambda r: (r.old, r.new))(gate.measured("x", "ms", call, call))), "slower")

    def test_by_hand(self):
        old = [10, 10, 10, 10, 10]
        for new, said in (([10, 10, 10, 10, 10], "same"), ([11.1, 11.1, 11.1, 11.1, 11.1], "slower"), ([10.9] * 5, "same"), ([12, 12, 12, 10, 10], "same"),
                          ([12, 12, 12, 12, 9], "slower"), ([8] * 5, "faster"), ([8, 8, 8, 8, 20], "faster"), ([8, 8, 8, 10, 10], "same")):
            self.assertEqual(gate.verdict(old, new), said, new)

    def test_an_old_build_that_cannot_says_so_and_does_not_count(self):
        def unable():
            raise gate.Unable("unknown option --smooth")
        row = gate.measured("x", "ms", unable, lambda: 1)
        self.assertEqual(row.says, "the old build says: unknown option --smooth")
        self.assertEqual(gate.judged([row]), [])
        self.assertIn("unknown option", before.row_words(vars(row), 1.1)[-1])

    def test_the_command_ends_with_1(self):
        slow, same = gate.Row("slow", old=[1] * 5, new=[1.3] * 5), gate.Row("same", old=[1] * 5, new=[1] * 5)
        self.assertEqual(before.slower({"rows": [vars(slow), vars(same)], "limit": 1.1}), ["slow"])
        self.assertEqual(before.slower({"rows": [vars(same)], "limit": 1.1}), [])
        page_of = before.before_page({"before": "old", "points": 1e6, "limit": 1.1, "size": [2, 1], "rows": [vars(slow), vars(same)]})
        self.assertIn("| slow | 1 ms | 1.30 ms | 1.30 (1.30 - 1.30): **slower** |", page_of)


class Plots(unittest.TestCase):
    def parsed(self, *given, **more):
        return xml.etree.ElementTree.fromstring(plot.lines(*given, **more))

    def test_are_xml_with_all_that_was_given(self):
        points = [(10**e, 2.0 * e) for e in range(5, 10)]
        svg = self.parsed("Time <of> a frame & more", "points", "ms", [("ewa", points), ("a & b", points[:3])], log_x=True, log_y=True,
                          ticks_x=[p[0] for p in points], name_of=words.power)
        tag = "{http://www.w3.org/2000/svg}"
        texts = [text.text for text in svg.iter(tag + "text")]
        for word in ("Time <of> a frame & more", "points", "ms", "ewa", "a & b", "10⁵", "10⁹"):
            self.assertIn(word, texts)
        self.assertEqual(len(list(svg.iter(tag + "circle"))), 8)
        left, top, width, height = 0, 0, *map(float, svg.get("viewBox").split()[2:])
        for circle in svg.iter(tag + "circle"):
            self.assertTrue(left < float(circle.get("cx")) < width and top < float(circle.get("cy")) < height)

    def test_no_two_lines_have_one_colour(self):
        for names in (["point", "paraboloid", "hqs", "pyramid", "point, every point"], ["each, median", "the slowest", "all together"], plot.METHODS):
            self.assertEqual(len(set(plot.colours_of(names))), len(names), names)
        self.assertEqual(plot.colours_of(["x", "ewa"])[1], plot.colours_of(["ewa"])[0])
        self.assertLess(max(plot.colours_of([str(i) for i in range(50)])), len(plot.COLOURS))

    def test_of_one_point_of_equal_values_and_of_zero(self):
        for points in ([(1, 1)], [(1, 5), (2, 5)], [(1, 0), (2, 0)]):
            self.parsed("t", "x", "y", [("s", points)])
        self.parsed("t", "x", "y", [("s", [(3, 3)])], log_x=True, log_y=True)
        with self.assertRaisesRegex(ValueError, "nothing to plot"):
            plot.lines("t", "x", "y", [("s", [])])

    def test_larger_is_higher_and_ends_are_apart(self):
        svg = self.parsed("t", "x", "y", [("a", [(1, 1), (2, 2)]), ("b", [(1, 1), (2, 2.01)])])
        at = [float(circle.get("cy")) for circle in svg.iter("{http://www.w3.org/2000/svg}circle")]
        self.assertGreater(at[0], at[1])
        for places in ([5, 5, 5], [1, 2, 40], [3, 1, 2]):
            moved = sorted(plot.apart(places, 16))
            self.assertTrue(all(b - a >= 15.999 for a, b in zip(moved, moved[1:])), places)
            self.assertAlmostEqual(sum(moved), sum(places), delta=40)


class Words(unittest.TestCase):
    def test_numbers(self):
        for value, text in ((0.01234, "0.012"), (0.5, "0.50"), (1.2345, "1.23"), (12.345, "12.3"), (123.4, "123"), (12345.6, "12,346"), (3, "3"), (None, "-"), (True, "yes")):
            self.assertEqual(words.number(value), text)
        for text, points in (("20M", 20_000_000), ("500k", 500_000), ("1G", 10**9), ("7", 7)):
            self.assertEqual(words.count(text), points)
            self.assertEqual(words.short(points), text)
        self.assertEqual([words.power(10**5), words.power(2 * 10**7)], ["10⁵", "2 · 10⁷"])
        with self.assertRaisesRegex(ValueError, "'many' is no number of points"):
            words.count("many")

    def test_rows_that_benchmarks_tell(self):
        sheet = told.Told()
        sheet.figure("fast", 5.0, "ms", low=4, high=6, most=4, reached=False)
        sheet.figure("slow", 7.25, "s")
        self.assertEqual(words.told_table(sheet.rows).splitlines()[2:], ["| fast | 5 ms (4 - 6) | at most 4: **missed** |", "| slow | 7.25 s |  |"])

    def test_what_was_measured_on(self):
        cpuinfo = "vendor_id\t: X\ncpu family\t: 25\nmodel\t\t: 1\nmodel name\t: AMD EPYC\nflags\t\t: fpu avx2 avx512f hypervisor\n"
        self.assertEqual(machine.processor(cpuinfo), "AMD EPYC, family 25 model 1, AVX-512")
        about = {"machine": {"cpu": "C", "cores": 1, "memoryGB": 3.5, "gpus": [], "virtual": True, "system": "D"}, "commit": {"hash": "abc", "changed": True},
                 "compiler": "g++ 12", "libraries": {"tbb": "2021.8", "z": "1.2"}}
        text = machine.words(about, ["2026-01-02", "2026-01-03"])
        for word in ("`abc`, with changes that are in no commit", "2026-01-02 to 2026-01-03", "C; 1 core, a virtual machine", "3.5 GB", "no graphics card", "g++ 12", "tbb 2021.8, z 1.2"):
            self.assertIn(word, text)

    @unittest.skipUnless(shutil.which("ninja"), "MISSING: ninja")
    def test_programs_of_another_tree_are_noticed(self):
        rules = "\n".join(["rule again", " command = true", " generator = 1", "build never: phony", "build build.ninja: again never",  # as CMake looks for new files
                           "rule copy", " command = cp $in $out", "build scancast: copy main.cpp", "build scancast-client: copy main.cpp", ""])
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(machine.stale(folder), "")  # built elsewhere
            for name, text in (("build.ninja", rules), ("main.cpp", "1")):
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
            self.assertIn("build first", machine.stale(folder))
            machine.said("ninja", "-C", folder, "-f", os.path.join(folder, "build.ninja"))
            self.assertEqual(machine.stale(folder), "")
            os.utime(os.path.join(folder, "main.cpp"), (4e9, 4e9))
            self.assertIn("build first", machine.stale(folder))

    def test_a_run_of_all_tests_is_read(self):
        class Given:
            tests_log = os.path.join(ROOT, "build-none")

        class Bench:
            given = Given()
        with tempfile.NamedTemporaryFile("w", suffix=".log") as log:
            log.write("== all green\ninstallation        2 s,    1 s of processor time\nrelease: build   400 s,  748 s of processor time\n")
            log.flush()
            Given.tests_log = log.name
            data = once.measure_tests(Bench)
        self.assertEqual(data["rows"], [["installation", 2, 1], ["release: build", 400, 748]])
        self.assertIn("| **all of them but installation** | 400 | 748 |", once.tests_page(data))

    def test_what_programs_print_is_read(self):
        line = "%-22s %-11s %-5s %-9s %-5s %3d %6.2f %6.2f  %6.2f %6.2f  %6.3f %6.3f  %6.2f %5.1f\n"  # bench_stability.cpp
        text = "cloud                  method      tau   motion    dist    n   mean\n"
        text += line % ("lion_takanawa.copc.laz", "square", "auto", "orbit", "0.5", 1, 3.95, 5, 0, 0, 0.01, 0.02, 1.5, 9)
        text += line % ("s.ply", "paraboloid", "auto", "orbit", "0.5", 64, 10.5, 5, 0, 0, 0.01, 0.02, 1.5, 9)
        self.assertEqual(pictures.moves_of(text), {("lion_takanawa.copc.laz", "square", 1): 3.95, ("s.ply", "paraboloid", 64): 10.5})
        rows = pictures.truth_of("scene,method,psnr,ssim,holes_percent,turned,turned_brute_force,levels_worst,ms,passes\n"
                                 "sign,ewa,23.01,0.9123,0.004,1.250,1.240,0.010,9.50,nearest 1.0; sum 2.0\n")
        self.assertIn("| sign | 23.0, 0.00 % |", pictures.truth_page({"rows": rows}))
        self.assertIn("| sign | 1.25 (0.01) |", pictures.truth_page({"rows": rows}))

    def test_tables_of_series_with_gaps(self):
        self.assertIn("| 2 | - | 4 |", growth.curves({"point": [[1, 3]], "x": [[1, 5], [2, 4]]}))


class TheCommand(unittest.TestCase):
    def run_it(self, *given):
        out, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
            try:
                code = command.main(list(given))
            except SystemExit as end:
                code = end.code
        return code, out.getvalue(), errors.getvalue()

    def test_refuses(self):
        for given, why in ((["--only", "nothing"], "no figures are called nothing"), (["--points", "many"], "'many' is no number of points"),
                           (["--quick"], "does not write docs/performance.md"), (["--limit", "0.5"], "--limit"),
                           (["--out", "/nowhere/page.md"], "there is no folder /nowhere"), (["--bin", "/nowhere"], "there is no scancast in /nowhere")):
            code, _, errors = self.run_it(*given)
            self.assertEqual(code, 2)
            self.assertIn(why, errors)

    def test_another_answer_measures_anew_and_the_same_does_not(self):
        with tempfile.TemporaryDirectory() as folder:
            log = os.path.join(folder, "tests.log")
            asked = lambda name, *more: command.asked_with(command.parse(["--data", folder, *more]), registry.named([name])[0])
            for name, more in (("tests", ["--tests-log", log]), ("gpu", ["--gpu-results", folder]), ("before", ["--before", log]), ("points", ["--points-up-to", "1G"]),
                               ("fast", ["--points", "5M"]), ("moves", ["--data", ROOT])):
                self.assertNotEqual(asked(name), asked(name, *more), name)
                self.assertEqual(asked(name, *more), asked(name, *more), name)
            self.assertEqual(asked("fast"), asked("fast", "--tests-log", log))
            before = asked("tests", "--tests-log", log)
            with open(log, "w", encoding="utf-8"):
                pass
            self.assertNotEqual(before, asked("tests", "--tests-log", log))

    def test_one_section_from_the_programs_to_the_page(self):
        if not BIN or not os.access(os.path.join(BIN, "scancast"), os.X_OK):
            self.skipTest("--bin names no folder with a scancast")
        with tempfile.TemporaryDirectory() as folder:
            out = os.path.join(folder, "page.md")
            given = ["--quick", "--only", "tau,gpu,before", "--bin", BIN, "--out", out, "--folder", os.path.join(folder, "work"), "--data", folder]
            code, printed, errors = self.run_it(*given)
            self.assertEqual((code, errors.count("[1/1]")), (0, 1), errors)
            self.assertIn("| 2 px |", printed)
            with open(out, encoding="utf-8") as file:
                text = file.read()
            hash_ = machine.commit()["hash"]
            self.assertEqual({commit.strip("`") for commit in page.COMMIT.findall(text)} - {hash_}, set())
            self.assertIn(f"Not measured at `{hash_}`: no other build was named", text)
            self.assertIn("figures mean nothing", text)
            self.assertEqual(page.prose(text), page.prose(ThePage.TEXT))
            self.assertIn("](images/tau.svg)", text)
            xml.etree.ElementTree.parse(os.path.join(folder, "images", "tau.svg"))
            self.assertNotIn("[1/1]", self.run_it(*given)[2])  # what was measured is kept


if __name__ == "__main__":
    if "--bin" in sys.argv:
        place = sys.argv.index("--bin")
        BIN = sys.argv[place + 1]
        del sys.argv[place:place + 2]
    unittest.main()
