"""Lines of points (XYZ, TXT, CSV, PTS), PTX, and the vertices of OBJ: lines counted, and the range of their first three numbers."""
import re

from declared.witness import Broken, Range, Witness

NAMES = (("x", "easting"), ("y", "northing"), ("z", "elevation"))


def numbers(words):
    return [float(word) for word in words]


def is_number(word):
    return re.fullmatch(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?(nan|inf|infinity)", word, re.I) is not None


def content(path):
    with open(path, "rb") as file:
        return file.read().decode("utf-8-sig", "replace").splitlines()


def split(line):
    if ";" in line:
        return [word.strip().replace(",", ".") for word in line.strip().strip(";").split(";")]
    if line.count(",") >= 2 and not re.search(r"\d,\d+\s+[-+\d]", line):
        return [word.strip() for word in line.strip().strip(",").split(",")]
    return line.replace(",", ".").split()


def examine_obj(path):
    seen, points = Range(), 0
    for line in content(path):
        words = line.split()
        if words[:1] == ["v"]:
            if len(words) < 4 or not all(map(is_number, words[1:4])):
                raise Broken("a vertex without three numbers")
            points += 1
            seen.take([tuple(numbers(words[1:4]))])
    return Witness("OBJ", points, seen.bounds(), 1e-6)


def looks_like_ptx(lines):
    widths = [1, 1, 3, 3, 3, 3, 4, 4, 4, 4]
    rows = [line.split() for line in lines[:10]]
    return [len(row) for row in rows] == widths and all(is_number(word) for row in rows for word in row)


def examine_ptx(path, lines):
    seen, points, at = Range(), 0, 0
    while at < len(lines):
        if not lines[at].strip():
            at += 1
            continue
        if not looks_like_ptx(lines[at:at + 10]):
            raise Broken(f"line {at + 1} begins no scan")
        cells = int(lines[at]) * int(lines[at + 1])
        m = [numbers(line.split()) for line in lines[at + 6:at + 10]]
        rows = [numbers(line.split()[:3]) for line in lines[at + 10:at + 10 + cells]]
        if len(rows) < cells or any(len(row) < 3 for row in rows):
            raise Broken("the points end early")
        seen.take(tuple(sum(p[k] * m[k][axis] for k in range(3)) + m[3][axis] for axis in range(3)) for p in rows if any(p))
        points += cells
        at += 10 + cells
    return Witness("PTX", points, seen.bounds(), 1e-6)


def examine(path):
    lines = content(path)
    if looks_like_ptx(lines):
        return examine_ptx(path, lines)
    found = Witness("PTS" if path.lower().endswith(".pts") else "text", 0, step=1e-6)
    seen, axes, width, started, promised = Range(), [0, 1, 2], None, False, 0
    for number, line in enumerate(lines, 1):
        bare = line.strip().strip("\0")
        comment = bare.startswith(("#", "//"))
        words = split(bare.lstrip("#/ ") if comment and not started else bare)
        if not words or not bare:
            continue
        lower = [re.sub(r"[\[(].*", "", word.strip("\"' ").lower()).strip() for word in words]
        if not started and not all(map(is_number, words)):
            if all(any(name in lower for name in names) for names in NAMES) and len(set(lower)) == len(lower):
                axes = [min(lower.index(name) for name in names if name in lower) for names in NAMES]
            elif not comment:
                raise Broken(f"line {number} is neither a point nor a header of points")
            started = started or not comment
            continue
        if comment:
            continue
        started = True
        if len(words) == 1 and words[0].isdigit():
            promised += int(words[0])
            continue
        if width is not None and len(words) != width:
            raise Broken(f"line {number} has {len(words)} columns, not {width}")
        width = len(words)
        if width <= max(axes) or not all(is_number(words[axis]) for axis in axes):
            raise Broken(f"line {number} is no point")
        found.points += 1
        seen.take([tuple(float(words[axis]) for axis in axes)])
    if found.points == 0:
        raise Broken("no points")
    if promised > found.points:
        raise Broken(f"{promised} points promised, {found.points} there")
    found.bounds = seen.bounds()
    return found
