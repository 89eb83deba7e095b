"""Words, facts and problems: Python's names are the server's, and nothing of a table is old."""
import dataclasses
import doctest
import importlib
import json
import os
import sys
import unittest
import unittest.mock

import support

import scancast
from scancast import _clouds, _decode, _exports, _http, _ranges, _rfc6455, _shapes, _values, _view_words, _wanted, errors, facts, words

sys.path.insert(0, support.PACKAGE)
import make_view_words  # noqa: E402

with open(os.path.join(support.ROOT, "protocol", "openapi.json"), encoding="utf-8") as file:
    OPENAPI = json.load(file)
SCHEMAS = OPENAPI["components"]["schemas"]


class Tables(unittest.TestCase):
    def test_the_words_of_a_view_are_those_of_the_protocol(self):
        with open(make_view_words.TARGET, encoding="utf-8") as file:
            self.assertEqual(file.read(), make_view_words.module(OPENAPI), "run client/python/make_view_words.py")

    def test_no_argument_of_ours_has_the_name_of_a_word(self):
        import inspect
        for method in (scancast.Cloud.snapshot, scancast.Cloud.save, scancast.Cloud.depth, scancast.Cloud.pick, scancast.Cloud.live,
                       scancast.Cloud.page, scancast.Cloud.widget, scancast.Cloud.link, scancast.LiveView.view, scancast.LiveView.still):
            ours = set(inspect.signature(method).parameters)
            self.assertEqual(ours & set(_view_words.PLACES), set(), method.__name__)

    def test_facts_have_what_the_protocol_has(self):
        picked = SCHEMAS["Picked"]["anyOf"][1]
        for kind, schema in ((facts.CloudFacts, SCHEMAS["Cloud"]), (facts.PendingCloud, SCHEMAS["PendingCloud"]), (facts.Live, SCHEMAS["Live"]),
                             (facts.Crs, SCHEMAS["Crs"]["anyOf"][1]), (facts.Look, SCHEMAS["Look"]), (facts.LookView, SCHEMAS["LookView"]), (facts.Mirror, SCHEMAS["Mirror"]),
                             (facts.Method, SCHEMAS["Method"]), (facts.Methods, SCHEMAS["MethodList"]), (facts.Parameter, SCHEMAS["Parameter"]),
                             (facts.PickedPoint, picked), (facts.NamedView, SCHEMAS["ViewList"]["properties"]["views"]["items"]),
                             (facts.Station, SCHEMAS["StationList"]["properties"]["stations"]["items"]),
                             (facts.Photo, SCHEMAS["PhotoList"]["properties"]["photos"]["items"])):
            ours = {_values.camel(field.name) for field in dataclasses.fields(kind)} - {"json"}
            self.assertEqual(ours, set(schema["properties"]), kind.__name__)
            needed = {_values.camel(field.name) for field in dataclasses.fields(kind)
                      if field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING}
            self.assertLessEqual(needed, set(schema.get("required", ())), f"{kind.__name__} asks for more than there has to be")

    def test_regions_are_those_of_the_protocol(self):
        self.assertEqual(set(_exports.RegionWords.__annotations__), set(SCHEMAS["Region"]["properties"]))

    def test_every_status_that_the_protocol_names_has_a_class_or_is_plainly_refused(self):
        for status, kind in errors._BY_STATUS.items():
            self.assertIs(type(errors.problem({"detail": "no"}, status)), kind)
        self.assertIs(type(errors.problem({}, 418)), errors.Refused)

    def test_doctests(self):
        for module in (_values, _clouds, _ranges, _shapes, words, _http, _rfc6455, _exports):
            failed, tried = doctest.testmod(module)
            self.assertEqual(failed, 0, module.__name__)
            self.assertGreater(tried, 0, module.__name__)

    def test_all_that_is_exported_is_there(self):
        for name in scancast.__all__:
            self.assertTrue(hasattr(scancast, name), name)
        for name in os.listdir(os.path.join(support.PACKAGE, "scancast")):
            if name.endswith(".py"):
                importlib.import_module("scancast." + name[:-3])


class Words(unittest.TestCase):
    def test_a_view_is_what_the_words_say(self):
        self.assertEqual(words.view_of({"projection": "orthographic", "view_height": 25, "clip": ((0, 0, 0), (1, 2, 3)), "near": None,
                                        "light": {"sun": (135, 40), "occlusion": "auto"}, "behind_mirrors": True, "method": "auto"}),
                         {"camera": {"type": "orthographic", "viewHeight": 25, "near": None}, "clip": {"min": [0, 0, 0], "max": [1, 2, 3]},
                          "light": {"sun": [135, 40], "occlusion": None}, "behindMirrors": True, "method": "auto"})

    def test_a_view_is_changed_as_the_protocol_says(self):
        base = {"camera": {"type": "perspective", "viewMatrix": [1], "fov": 60}, "method": "ewa", "param": {"scale": 2}, "light": {"sun": [1, 2]}}
        changed = words.view_of({"eye": (1, 2, 3), "method": "cone", "light": {"shadow": 1}}, base)
        self.assertEqual(changed, {"camera": {"type": "perspective", "fov": 60, "eye": [1, 2, 3]}, "method": "cone",
                                   "light": {"sun": [1, 2], "shadow": 1}})
        self.assertEqual(words.view_of({"projection": "orthographic", "view_height": 5}, base)["camera"],
                         {"type": "orthographic", "viewMatrix": [1], "viewHeight": 5})
        self.assertEqual(base["param"], {"scale": 2}, "what was given stays as it was")

    def test_bounds_and_arrays_are_values(self):
        self.assertEqual(words.view_of({"clip": scancast.Bounds((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))}), {"clip": {"min": [0, 0, 0], "max": [1, 1, 1]}})
        if support.has("numpy"):
            import numpy
            self.assertEqual(words.view_of({"eye": numpy.array([1, 2, 3.5]), "width": numpy.int64(64)}), {"camera": {"eye": [1, 2, 3.5]}, "width": 64})

    def test_what_json_cannot_have_is_named(self):
        for given in ({"eye": (0, float("nan"), 0)}, {"param": {"scale": float("inf")}}, {"color": object()}):
            with self.assertRaisesRegex(ValueError, next(iter(given))):
                words.view_of(given)

    def test_several_clouds_are_written_either_way(self):
        text = ".,tint:ff8800;town-2024,shift:0:0:0.12;b,hidden"
        clouds = _clouds.clouds_of(text)
        self.assertEqual(_clouds.clouds_text(clouds), text)
        self.assertEqual(words.view_of({"with_": text}), {"with": clouds})
        self.assertEqual(words.view_of({"with_": clouds}), {"with": clouds})
        self.assertEqual(words.view_of({"with_": "auto"}), {"with": None})
        self.assertEqual(words.words_text({"with": clouds}), [("with", text)])
        for strange in ("b,sideways", "b,shift:1:2", "b,shift:1:2:x"):
            self.assertEqual(_clouds.clouds_of(strange), strange)

    def test_shapes_that_cut_are_written_either_way(self):
        text = "box:5,5,2,10,4,4,30;-box:1,2,3,4,5,6;plane:0,0,3,0,0,-1;box:1,2,3,4,5,6,0,10,20"
        shapes = _shapes.shapes_of(text)
        self.assertEqual(_shapes.shapes_text(shapes), text)
        self.assertEqual(shapes[1]["keep"], "outside")
        for strange in ("box:1,2", "ball:1,2,3", "", "box"):
            self.assertEqual(_shapes.shapes_of(strange), strange)
        self.assertEqual(words.view_of({"clips": "plane:0,0,3,0,0,-1"}), {"clips": [{"plane": {"point": [0, 0, 3], "normal": [0, 0, -1]}}]})

    def test_ranges_of_columns_are_written_either_way(self):
        text = "a:1..2;b; c%25:..-3;d:e:1e-05.."
        text = text.replace("b; c", "b%3B c")
        ranges = _ranges.ranges_of(text)
        self.assertEqual(ranges, [{"column": "a", "low": 1, "high": 2}, {"column": "b; c%", "high": -3}, {"column": "d:e", "low": 1e-5}])
        self.assertEqual(_ranges.ranges_of(_ranges.ranges_text(ranges)), ranges)
        for strange in ("a", "a:1", ":1..2", "", "a:x..", "a%:1.."):
            self.assertEqual(_ranges.ranges_of(strange), strange)
        self.assertEqual(words.view_of({"filter": "a:1.."}), {"filter": [{"column": "a", "low": 1}]})


class Wanted(unittest.TestCase):
    def test_what_was_refused_is_not_asked_for_again(self):
        wanted = _wanted.Wanted()
        self.assertFalse(wanted.welcome({"camera": {"eye": [0, 0, 0]}, "method": "cone", "cloud": "a"}, 0))
        wanted.ask(1, {"camera": {"eye": [1, 1, 1]}})
        wanted.ask(2, {"method": "nonsense"})
        wanted.ask(3, {"color": "rgb"})
        wanted.refused(2)
        self.assertEqual(wanted.view, {"camera": {"eye": [1, 1, 1]}, "method": "cone", "color": "rgb"})
        wanted.shown(1)
        self.assertTrue(wanted.welcome({"camera": {"eye": [1, 1, 1]}, "method": "cone"}, 1), "the server has missed 3")
        self.assertEqual(wanted.view["color"], "rgb")
        self.assertFalse(wanted.welcome({"method": "disc"}, 3), "what somebody else has driven it to")
        self.assertEqual(wanted.view, {"method": "disc"})

    def test_many_changes_are_kept_as_one_view(self):
        wanted = _wanted.Wanted()
        for seq in range(1000):
            wanted.ask(seq, {"camera": {"eye": [seq, 0, 0]}})
        self.assertEqual(wanted.view, {"camera": {"eye": [999, 0, 0]}})
        self.assertLessEqual(len(wanted._changes), 64)


class Problems(unittest.TestCase):
    def test_all_that_is_said_is_there(self):
        error = errors.problem({"type": "urn:scancast:problem:resource-limit", "title": "Too large", "status": 413, "detail": "viewHeight is dear.",
                                "price": 31.5, "limit": 20, "nearest": {"samples": 39.0, "viewHeight": 2.5}, "requestId": "r1",
                                "errors": [{"parameter": "camera.viewHeight", "detail": "viewHeight: no"}, "nonsense"]}, 413, "7")
        self.assertIsInstance(error, scancast.TooLarge)
        self.assertEqual((str(error), error.type, error.title, error.price, error.limit, error.retry_after, error.request_id),
                         ("view_height is dear.", "resource-limit", "Too large", 31.5, 20.0, 7.0, "r1"))
        self.assertEqual(error.nearest, {"samples": 39, "view_height": 2.5})
        self.assertIsInstance(error.nearest["samples"], int)
        self.assertEqual(error.errors, [("camera.view_height", "view_height: no")])

    def test_nothing_of_them_is_a_command_to_a_terminal(self):
        evil = "no \x1b]0;title\x07\u202e\r\n"
        error = errors.problem({"detail": evil, "title": evil, "type": evil, "requestId": evil, "errors": [{"parameter": evil, "detail": evil}]}, 400)
        for text in (str(error), error.detail, error.title, error.type, error.request_id, *error.errors[0]):
            self.assertTrue(text.isprintable(), repr(text))

    def test_anything_makes_one(self):
        for told in ({}, {"status": "x", "errors": 3, "nearest": [], "price": True, "detail": None}, {"detail": 5}):
            self.assertTrue(str(errors.problem(told, 400, "soon")))

    def test_they_are_what_python_calls_them_too(self):
        self.assertIsInstance(errors.problem({}, 404), LookupError)
        self.assertIsInstance(errors.problem({}, 401), PermissionError)
        self.assertIsInstance(errors.problem({}, 400), ValueError)

    def test_numbers_that_no_float_holds_are_infinite(self):
        error = errors.problem({"price": 10**400, "limit": -10**400, "nearest": {"width": 10**400}}, 413)
        self.assertEqual((error.price, error.limit), (float("inf"), -float("inf")))


class Decoding(unittest.TestCase):
    def test_what_is_wrong_is_named(self):
        for told, named in (([], "parameter"), ({"name": 1}, "parameter.name"), ({"name": "a", "type": "number"}, "default"),
                            ({"name": "a", "type": "b", "default": 1, "meaning": "c", "choices": [1]}, r"choices\[0\]"),
                            ({"name": "a", "type": "b", "default": 1, "meaning": "c", "min": True}, "min"),
                            ({"name": "a", "type": "b", "default": 1, "meaning": "c", "min": -10**400}, "min is no number")):
            with self.assertRaisesRegex(scancast.BadAnswer, named):
                _decode.decode(facts.Parameter, told, "parameter")

    def test_newer_members_do_no_harm(self):
        parameter = _decode.decode(facts.Parameter, {"name": "a", "type": "b", "default": 1, "meaning": "c", "newer": {}, "min": 1}, "parameter")
        self.assertEqual((parameter.min, parameter.choices), (1.0, []))


class Addresses(unittest.TestCase):
    def test_a_pass_may_end_at_any_time(self):
        transport = _http.Transport("http://a/#guest=scg1.a.b", None, 1.0, None, 0.0)
        answer = {"token": "pass", "expiresInSeconds": 10**400}
        with unittest.mock.patch.object(transport, "_once"), unittest.mock.patch.object(transport, "_json_of", return_value=answer):
            self.assertEqual(transport.token(), "pass")

    def test_what_is_a_servers(self):
        self.assertEqual(_http.parse_url("https://a.example:8443/")[0], (True, "a.example", 8443))
        self.assertEqual(_http.parse_url("http://[::1]:80")[0].authority, "[::1]:80")
        self.assertEqual(_http.parse_url("https://a.example/#guest=scg1.a.b&eye=1,2,3")[1], "scg1.a.b")

    def test_what_is_none_and_no_secret_is_repeated(self):
        for text in ("a.example", "ftp://a/", "http:///", "http://a/b", "http://a/?x", "http://a:99999/", "http://user:secret@a/", "http://a b/",
                     "http://a/b#guest=secret"):
            with self.assertRaises(ValueError) as caught:
                _http.parse_url(text)
            self.assertNotIn("secret", str(caught.exception))
        for token in ("", "two words", "a\nb", "ä"):
            with self.assertRaises(ValueError):
                scancast.Server("http://127.0.0.1/", token=token)
        self.assertNotIn("secret", repr(scancast.Server("http://127.0.0.1/", token="secret-secret-secret")))


if __name__ == "__main__":
    unittest.main()
