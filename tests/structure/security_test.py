"""docs/security.md names tests and code that are there, and every fuzz target and load that is.

A word in a table's column "test" is a test of GoogleTest (Suite.Name), a test of CTest, or a file.
"""
import re
import unittest

import tree

PAGE = "docs/security.md"


def googletests(files):
    """Suite.Name of all there are."""
    return {f"{m[1]}.{m[2]}" for path, text in files.items() if path.endswith("_test.cpp")
            for m in re.finditer(r"\bTEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text)}


def commands(files):
    """Tests of CTest that are programs or scripts, fuzz targets among them."""
    found = set()
    for path, text in files.items():
        if path.startswith("tests/") and path.endswith("CMakeLists.txt"):
            found |= set(re.findall(r"scancast_command_test\(([\w.]+)", text)) | set(re.findall(r"scancast_fuzz\((\w+)", text))
            for names in re.findall(r"foreach\(parser ([\w ]+)\)", text):
                found |= {"fuzz_" + name for name in names.split()}
    return found - {"fuzz_"}


def tables(text):
    """Of each table its header and its rows, as lists of cells."""
    for table in re.findall(r"(?m)(?:^\|.*\n)+", text):
        header, _, *rows = ([cell.strip() for cell in line.strip("|\n").split(" | ")] for line in table.splitlines())
        yield header, rows


def complaints(files, exists):
    text = files[PAGE]
    known = googletests(files) | commands(files)
    for header, rows in tables(text):
        for row in rows:
            if header[-1] == "test":
                named = re.findall(r"`([^`]+)`", row[-1])
                if not named:
                    yield f"{row[0]}: no test"
                for name in named:
                    if name not in known and not ("/" in name and exists(name)):
                        yield f"{row[0]}: there is no test {name}"
            for name in re.findall(r"`((?:server|client|files|protocol|renderer|transport|tests)/[\w./-]+)`", " ".join(row)):
                if not exists(name):
                    yield f"{row[0]}: there is no {name}"
    first = {header[0]: {row[0].strip("`") for row in rows} for header, rows in tables(text)}
    fuzzed = {name for name in commands(files) if name.startswith("fuzz_")}
    yield from (f"{name} is missing in the table of what is fuzzed" for name in fuzzed - first["target"])
    yield from (f"{name} is no fuzz target" for name in first["target"] - fuzzed)
    loads = set(re.findall(r'^    "([\w ]+)": \(', files["tests/attack/loads.py"], re.M))
    yield from (f"the load {name} is missing in the table of floods" for name in loads - first["load"])
    yield from (f"{name} is no load" for name in first["load"] - loads)


class ThePage(unittest.TestCase):
    def test_names_what_is_there(self):
        files = tree.files()
        self.assertGreater(len(googletests(files)), 1000)
        self.assertGreater(len([name for name in commands(files) if name.startswith("fuzz_")]), 15)
        tree.fail_with(self, complaints(files, tree.exists))


class ComplaintsAreMade(unittest.TestCase):
    def test_of_tests_targets_and_loads_that_are_not_there(self):
        page = ("| threat | defence | test |\n|---|---|---|\n| a | `server/a.cpp` | `Real.One`, `deploy.all` |\n"
                "| b | b | `Real.Two`, `tests/b.py` |\n| c | c | by hand |\n\n"
                "| target | reads | from |\n|---|---|---|\n| `fuzz_old` | x | y |\n\n| load | ms |\n|---|---|\n| floods | |\n")
        files = {PAGE: page, "tests/unit/a_test.cpp": "TEST_F(Real, One) {", "tests/attack/loads.py": '    "pings": (4, x),\n',
                 "tests/CMakeLists.txt": "scancast_command_test(deploy.all LABEL net)\nscancast_fuzz(fuzz_new SOURCES x)"}
        self.assertEqual(["a: there is no server/a.cpp", "b: there is no test Real.Two", "b: there is no test tests/b.py",
                          "b: there is no tests/b.py", "c: no test", "floods is no load", "fuzz_new is missing in the table of what is fuzzed", "fuzz_old is no fuzz target",
                          "the load pings is missing in the table of floods"], sorted(complaints(files, lambda path: False)))


if __name__ == "__main__":
    unittest.main()
