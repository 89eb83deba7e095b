"""What first_sight.py measures, on pictures so simple that the right number can be seen, and how it divides scans. Nothing is
rendered here."""
import os
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))
import first_sight  # noqa: E402
import png_file  # noqa: E402
from sight import label, measure, sheet  # noqa: E402

WIDTH, HEIGHT = 100, 50
GROUND = (20, 20, 20)


def pictures(colour_at):
    """The two pictures of what has a colour at x, y, or None where nothing is."""
    seen, cut_out = bytearray(), bytearray()
    for y in range(HEIGHT):
        for x in range(WIDTH):
            colour = colour_at(x, y)
            seen += bytes(colour or GROUND)
            cut_out += bytes((*colour, 255)) if colour else bytes(4)
    return png_file.Picture(WIDTH, HEIGHT, 3, bytes(seen)), png_file.Picture(WIDTH, HEIGHT, 4, bytes(cut_out))


def numbers_of(colour_at, points_at=None):
    return measure.measured(*pictures(colour_at), pictures(points_at)[1] if points_at else None)


def failures(numbers, touched=measure.TOUCHED):
    return [criterion for criterion, _ in measure.failed(numbers, touched)]


def grey(level):
    return level, level, level


def steps(x, y):
    """A block that is all a picture should be: large, in the middle, of many greys, with edges."""
    return grey(40 + 22 * (x // 2 % 10)) if 5 <= x < 95 and 5 <= y < 45 else None


class Measure(unittest.TestCase):
    def test_a_good_picture(self):
        numbers = numbers_of(steps)
        self.assertEqual(failures(numbers), [])
        self.assertAlmostEqual(numbers["covered"], 90 * 40 / 5000)
        self.assertEqual(numbers["touched"], 0)
        self.assertEqual(numbers["unlike"], 0)
        self.assertAlmostEqual(numbers["spread"], 198 / 255)

    def test_the_box_knows_its_size_and_place(self):
        numbers = numbers_of(lambda x, y: grey(90) if 10 <= x < 30 and 40 <= y < 50 else None)
        self.assertEqual(numbers["fill"], [0.2, 0.2])
        self.assertAlmostEqual(numbers["middle"][0], -0.3)
        self.assertAlmostEqual(numbers["middle"][1], 0.4)
        self.assertLessEqual({"fill", "middle", "border"}, set(failures(numbers)))

    def test_a_few_stray_pixels_do_not_make_a_box_large(self):
        strays = {(0, 0), (99, 0), (0, 49), (99, 49)}
        numbers = numbers_of(lambda x, y: grey(90) if (x, y) in strays or 40 <= x < 60 and 15 <= y < 35 else None)
        self.assertEqual(numbers["fill"], [0.2, 0.4])

    def test_each_pixel_of_the_border_counts_once(self):
        ring = 2 * (WIDTH + HEIGHT) - 4
        for spots in ({(0, 0)}, {(99, 49)}, {(99, 0), (0, 49)}, {(0, 7), (99, 7), (50, 0), (50, 49)}):
            numbers = numbers_of(lambda x, y: grey(90) if (x, y) in spots or (x, y) == (50, 25) else None)
            self.assertAlmostEqual(numbers["touched"], len(spots) / ring)
        self.assertEqual(numbers_of(lambda x, y: grey(90))["touched"], 1)

    def test_what_may_touch_the_border(self):
        allowed = measure.touched_allowed
        for kind in ("airborne", "street", "indoor", "depth-frame"):
            self.assertEqual(allowed({"kind": kind}), measure.TOUCHED_AROUND)
        self.assertEqual(allowed({"kind": "object", "inside": False}), measure.TOUCHED)
        self.assertEqual(allowed({"kind": "object", "inside": True}), measure.TOUCHED_AROUND)
        self.assertEqual(allowed({"kind": "object"}, "landscape"), measure.TOUCHED)
        for nothing in (None, {}, {"kind": None}):
            self.assertEqual(allowed(nothing), measure.TOUCHED)
            self.assertEqual(allowed(nothing, "landscape"), measure.TOUCHED_AROUND)
        half = numbers_of(lambda x, y: steps(x, 25) if y >= 25 else None)
        self.assertIn("border", failures(half))
        self.assertNotIn("border", failures(half, measure.TOUCHED_AROUND))

    def test_luminance_weighs_colours(self):
        for colour, luminance in (((255, 0, 0), 0.2126), ((0, 255, 0), 0.7152), ((0, 0, 255), 0.0722), ((255, 255, 255), 1)):
            self.assertAlmostEqual(numbers_of(lambda x, y: colour)["median"], luminance)

    def test_one_colour(self):
        numbers = numbers_of(lambda x, y: (200, 100, 55) if x < 40 else (16 * (x % 16), 8, 8))
        self.assertAlmostEqual(numbers["one_colour"], 0.4)
        self.assertEqual(numbers["colour"], "#c63")
        self.assertIn("colour", failures(numbers))

    def test_edges_lie_inside(self):
        flat = numbers_of(lambda x, y: grey(250) if 20 <= x < 80 else None)  # a bright thing on dark ground
        self.assertEqual(flat["edges"], 0)
        numbers = numbers_of(lambda x, y: grey(50 if x < 50 else 200))
        self.assertAlmostEqual(numbers["edges"], 2 / WIDTH)  # one column on each side
        slope = measure.STEEP * 255
        self.assertEqual(numbers_of(lambda x, y: grey(int(y % 10 * (slope - 1))) if y < 10 else None)["edges"], 0)
        self.assertEqual(numbers_of(lambda x, y: grey(int(y % 10 * (slope + 1))) if y < 10 else None)["edges"], 1)

    def test_noise_is_that_of_points_at_most(self):
        smooth = lambda x, y: grey(100 + x)  # a slope is no noise
        rough = lambda x, y: grey(100 + x + 37 * (x * 7 + y * 3) % 41)
        self.assertLess(numbers_of(smooth, smooth)["noise"], 0.005)
        self.assertGreater(numbers_of(rough, smooth)["noise"], 0.02)
        self.assertIn("noise", failures(numbers_of(rough, smooth)))
        self.assertNotIn("noise", failures(numbers_of(rough, rough)))
        self.assertNotIn("noise", failures(numbers_of(smooth, rough)))
        self.assertNotIn("noise", numbers_of(rough))

    def test_noise_of_single_points_is_unknown(self):
        numbers = numbers_of(steps, lambda x, y: grey(90) if x % 2 == y % 2 == 0 else None)
        self.assertIsNone(numbers["points_noise"])
        self.assertEqual(failures(numbers), [])

    def test_nothing_in_the_picture(self):
        self.assertEqual(failures(numbers_of(lambda x, y: None)), ["empty"])

    def test_pictures_of_two_views_are_noticed(self):
        seen, _ = pictures(steps)
        _, other = pictures(lambda x, y: steps(x + 1, y))
        self.assertGreater(measure.measured(seen, other)["unlike"], 0.1)


class Scans(unittest.TestCase):
    def test_a_folder_is_searched(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.las", "A.LAZ", "c.copc.laz", "notes.md", "deep/er/d.e57", "bad/e.las", "tree/cloud.js", "tree/data/r/r.laz",
                         "tree2/metadata.json", "tree2/octree.bin"):
                path = os.path.join(folder, name)
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "wb"):
                    pass
            found = [os.path.relpath(path, folder) for path in first_sight.scans_beneath(folder)]
            self.assertEqual(found, ["A.LAZ", "a.las", "c.copc.laz", "deep/er/d.e57", "tree/cloud.js", "tree2/metadata.json"])
            tree = os.path.join(folder, "tree")
            self.assertEqual(first_sight.index_of(tree), os.path.join(tree, "cloud.js"))
            self.assertEqual(first_sight.names_of([os.path.join(tree, "cloud.js"), "a.las", "b/a.las", "a b"]), ["tree", "a.las", "a.las.2", "a_b"])

    def test_halves(self):
        self.assertEqual(first_sight.half_of("/x/y/autzen_trim.las"), "even")
        self.assertEqual(first_sight.half_of("z/ahn3-delft.laz"), "odd")

    def test_flags_are_replaced(self):
        flags = ["--samples", "1", "--method", "disc", "--background=#ffffff"]
        self.assertEqual(first_sight.with_words(flags, first_sight.POINTS),
                         ["--samples", "1", "--background", "transparent", "--color", "rgb", "--method", "point", "--shading", "unlit"])

    def test_rates(self):
        results = [{"state": state, "half": half, "name": "n"} for state, half in
                   (("pass", "even"), ("fail", "even"), ("fail", "odd"), ("small", "odd"), ("unreadable", "even"))]
        self.assertEqual(first_sight.rates(results), {"all": [1, 3], "try": [1, 2], "held back": [0, 1]})


class Sheet(unittest.TestCase):
    def test_small_pictures_are_means(self):
        picture = png_file.Picture(8, 4, 3, bytes((x * 10 + c for y in range(4) for x in range(8) for c in range(3))))
        small = sheet.shrunk(picture, 2, 2)
        self.assertEqual(small, (2, 1, 3, bytes((15, 16, 17, 55, 56, 57))))
        self.assertEqual(sheet.shrunk(picture), picture)
        self.assertEqual(sheet.shrunk(png_file.Picture(1280, 720, 3, bytes(1280 * 720 * 3)))[:2], (320, 180))

    def test_every_character_has_a_shape(self):
        self.assertEqual(len(label.GLYPHS), 95)
        self.assertEqual([ord(c) for c in label.GLYPHS], list(range(32, 127)))
        for shape in label.GLYPHS.values():
            self.assertEqual([len(row) for row in shape], [label.WIDE] * label.HIGH)
        shapes = ["".join(shape) for shape in label.GLYPHS.values()]
        self.assertEqual(len(set(shapes)), 95)

    def test_a_sheet_has_room_for_all(self):
        small = png_file.Picture(sheet.WIDE, sheet.HIGH, 3, b"\x80" * (3 * sheet.WIDE * sheet.HIGH))
        name = "a-very-long-name-that-does-not-fit-into-the-room-there-is.las"
        entries = [sheet.Entry(name, mark, "no", small) for mark in ("pass", "fail", "small")]
        for count in (1, 4, 5):
            picture = sheet.sheet((entries * 2)[:count])
            self.assertEqual(len(picture.pixels), 3 * picture.width * picture.height)
            self.assertIn(bytes(sheet.MARKS["pass"]) * 5, picture.pixels)
        self.assertIsNone(sheet.sheet([]))


if __name__ == "__main__":
    unittest.main()
