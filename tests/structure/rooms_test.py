"""Nothing includes upwards: every #include "..." of the product against the rooms that ARCHITECTURE.md declares.

The declaration is its block ```rooms. A line is a floor, the highest first; on it stand rooms: `folder`, without the folders
in it; `folder/**`, with them; `folder/name.*`, files that belong here and not to their folder. A file may include its own room and
all floors below, not the other rooms of its floor. On a line `ROOM …: ROOM …` the former may include the latter, and nothing else.
"""
import posixpath
import re
import unittest

import tree

PRODUCT = ("protocol/", "files/", "threads/", "remote/", "transport/", "renderer/", "simulator/", "video/", "server/", "client/", "importers/", "ranks/")
PICTURES = (".jpg", ".png", ".svg", ".ico")
MOST_FILES = 30
CROWDED = set()  # folders that are still to be divided; who does so takes them out here


def declared(page):
    """{room: (floor, rooms that alone it may include, or None)}; floor 0 is the lowest."""
    block = re.search(r"(?ms)^```rooms\n(.*?)^```", page)
    lines = [line.split("#")[0].strip() for line in block[1].splitlines()] if block else []
    rooms = {}
    for floor, line in enumerate(reversed([line for line in lines if line])):
        names, colon, only = line.partition(":")
        for name in names.split():
            if name in rooms:
                raise ValueError(f"{name} is declared twice")
            rooms[name] = (floor, set(only.split()) if colon else None)
    for name, (floor, only) in rooms.items():
        if wrong := [room for room in only or () if room not in rooms or rooms[room][0] >= floor]:
            raise ValueError(f"{name} may not include {wrong[0]}, which does not stand below it")
    return rooms


def room_of(path, rooms):
    """The most particular one that the file is in, or None."""
    folder = posixpath.dirname(path)
    names = [path, posixpath.splitext(path)[0] + ".*", folder]
    while folder:
        names.append(folder + "/**")
        folder = posixpath.dirname(folder)
    return next((name for name in names if name in rooms), None)


def why_not(path, target, rooms):
    """Why one file must not include the other, or None."""
    here, there = room_of(path, rooms), room_of(target, rooms)
    if here is None or there is None or here == there:
        return None
    (floor, only), (below, _) = rooms[here], rooms[there]
    if only is not None:
        return None if there in only else f"{here} may include {', '.join(sorted(only))} only"
    if below == floor:
        return f"{there} stands beside {here}"
    return f"{there} stands above {here}" if below > floor else None


def included(path, text, files):
    """Files of the project that this one includes: named from the root, or from its own folder; of shaders, by name alone."""
    if path.endswith((".comp", ".glsl")):
        return
    for name in re.findall(r'(?m)^[ \t]*#[ \t]*include[ \t]+"([^"]+)"', text):
        beside = posixpath.normpath(posixpath.join(posixpath.dirname(path), name))
        yield name, name if name in files else beside if beside in files else None


def complaints(files, rooms):
    for path, text in files.items():
        if room_of(path, rooms) is None:
            yield f"{posixpath.dirname(path)} is no declared room: put it into ARCHITECTURE.md's order"
        for name, target in included(path, text, files):
            if target is None:
                yield f"{path}: includes {name}, which is not there"
            elif why := why_not(path, target, rooms):
                yield f"{path}: includes {name}, but {why}"


def crowds(paths, allowed=frozenset()):
    count = {}
    for path in paths:
        if not path.endswith(PICTURES):
            count[posixpath.dirname(path)] = count.get(posixpath.dirname(path), 0) + 1
    crowded = {folder for folder, n in count.items() if n > MOST_FILES}
    yield from (f"{folder}: {count[folder]} files, more than {MOST_FILES}" for folder in sorted(crowded - allowed))
    yield from (f"{folder}: no crowd any more, take it out of CROWDED" for folder in sorted(allowed - crowded))


def empty_rooms(files, rooms):
    return [room for room in rooms if not any(room_of(path, rooms) == room for path in files)]


class TheTree(unittest.TestCase):
    def setUp(self):
        self.page = tree.files(".md")["ARCHITECTURE.md"]
        self.code = {p: t for p, t in tree.files(".hpp", ".cpp", ".inl", ".comp", ".glsl").items() if p.startswith(PRODUCT)}

    def test_nothing_includes_upwards(self):
        self.assertGreater(len(self.code), 300)
        tree.fail_with(self, complaints(self.code, declared(self.page)))

    def test_every_declared_room_is_there(self):
        tree.fail_with(self, empty_rooms(self.code, declared(self.page)))

    def test_folders_are_no_crowds(self):
        tree.fail_with(self, crowds((p for p in tree.paths() if p.startswith((*PRODUCT, "tests/"))), CROWDED))


class ComplaintsAreMade(unittest.TestCase):
    ROOMS = declared("```rooms\nattic attic/twin   # the top\nhall/door.*\nhall annex/**\nporch: cellar\ncellar\n```\n")

    def of(self, path, *names):
        text = "".join(f'#include "{name}"\n' for name in names)
        files = {"attic/a.hpp": "", "attic/twin/t.hpp": "", "hall/h.hpp": "", "hall/door.hpp": "", "annex/x.hpp": "", "annex/in/y.hpp": "",
                 "porch/p.hpp": "", "cellar/c.hpp": ""}
        return list(complaints({**files, path: text}, self.ROOMS))

    def test_of_nothing_downwards(self):
        self.assertEqual([], self.of("attic/b.cpp", "attic/a.hpp", "hall/h.hpp", "cellar/c.hpp", "a.hpp"))
        self.assertEqual([], self.of("hall/door.cpp", "hall/h.hpp", "annex/x.hpp", "door.hpp"))
        self.assertEqual([], self.of("annex/in/z.cpp", "annex/x.hpp"))
        self.assertEqual([], self.of("annex/z.cpp", "annex/in/y.hpp", "cellar/c.hpp"))
        self.assertEqual([], self.of("porch/q.cpp", "cellar/c.hpp"))

    def test_of_includes_upwards_and_sideways(self):
        self.assertEqual(["hall/i.cpp: includes attic/a.hpp, but attic stands above hall"], self.of("hall/i.cpp", "attic/a.hpp"))
        self.assertEqual(["hall/i.cpp: includes annex/x.hpp, but annex/** stands beside hall"], self.of("hall/i.cpp", "annex/x.hpp"))
        self.assertEqual(["hall/i.cpp: includes door.hpp, but hall/door.* stands above hall"], self.of("hall/i.cpp", "door.hpp"))
        self.assertEqual(["porch/q.cpp: includes hall/h.hpp, but porch may include cellar only"],
                         self.of("porch/q.cpp", "hall/h.hpp"))

    def test_of_rooms_that_nobody_declared_and_files_that_are_not_there(self):
        self.assertEqual(["shed is no declared room: put it into ARCHITECTURE.md's order"], self.of("shed/s.cpp"))
        self.assertEqual(["hall/i.cpp: includes cellar/no.hpp, which is not there"], self.of("hall/i.cpp", "cellar/no.hpp"))

    def test_of_rooms_without_files_and_rooms_declared_twice(self):
        self.assertEqual(["annex"], empty_rooms(["hall/h.hpp"], {"hall": (0, None), "annex": (0, None)}))
        self.assertRaises(ValueError, declared, "```rooms\nhall\nhall\n```\n")
        self.assertRaises(ValueError, declared, "```rooms\nhall: attic\nporch\n```\n")
        self.assertRaises(ValueError, declared, "```rooms\nattic\nhall: attic\nporch\n```\n")
        self.assertEqual({}, declared("no block"))

    def test_of_crowds(self):
        full, crowd = [f"hall/{i}.cpp" for i in range(30)], [f"hall/{i}.cpp" for i in range(31)]
        self.assertEqual([], list(crowds(full + ["hall/a.png"])))
        self.assertEqual(["hall: 31 files, more than 30"], list(crowds(crowd)))
        self.assertEqual([], list(crowds(crowd, {"hall"})))
        self.assertEqual(["hall: no crowd any more, take it out of CROWDED"], list(crowds(full, {"hall"})))


if __name__ == "__main__":
    unittest.main()
