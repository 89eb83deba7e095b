"""Python's half of the notebook's view, with anywidget's place taken by what it promises; its other half is tests/browser/notebook.test.mjs'."""
import contextlib
import json
import sys
import types
import unittest
import unittest.mock

import support

import scancast
from scancast import widget
from scancast._http import Transport


@contextlib.contextmanager
def with_modules(**modules):
    """These modules, or none (None) of that name."""
    widget._widget_class.cache_clear()
    with unittest.mock.patch.dict(sys.modules, modules):
        yield
    widget._widget_class.cache_clear()


class WithoutLibraries(unittest.TestCase):
    def test_who_lacks_a_library_is_told_how_to_get_it(self):
        transport = Transport("http://127.0.0.1:1", None, 1.0, None, 0.0)
        with with_modules(anywidget=None), self.assertRaisesRegex(scancast.MissingLibrary, "pip install anywidget.*page"):
            widget.make_widget(transport, "town", {}, 480)
        picture = scancast.Picture(b"", "image/png")
        with with_modules(numpy=None), self.assertRaisesRegex(ImportError, "pip install numpy.*python3-numpy"):
            picture.array()
        with with_modules(numpy=None), self.assertRaisesRegex(scancast.MissingLibrary, "NumPy"):
            scancast.DepthPicture(b"", 0, 0).array()
        with with_modules(**{"PIL": None, "PIL.Image": None}), self.assertRaisesRegex(scancast.MissingLibrary, "pip install pillow.*python3-pil"):
            picture.image()

    @support.needs("PIL")
    def test_what_is_no_picture_is_told(self):
        for data in (b"", b"GIF89a", b"\x89PNG\r\n\x1a\n" + bytes(40)):
            with self.assertRaises(scancast.BadAnswer):
                scancast.Picture(data, "image/png").image()


@support.needs("traitlets")
class Widget(unittest.TestCase):
    def setUp(self):
        import traitlets

        class AnyWidget(traitlets.HasTraits):
            def __init__(self, **traits):
                self.sent, self.answers = [], []
                super().__init__(**traits)

            def on_msg(self, callback):
                self.answers.append(callback)

            def send(self, content, buffers=None):
                self.sent.append((content, buffers) if buffers else content)

        context = with_modules(anywidget=types.SimpleNamespace(AnyWidget=AnyWidget))
        context.__enter__()
        self.addCleanup(context.__exit__, None, None, None)

    def made(self, token=None, **view):
        return widget.make_widget(Transport("http://127.0.0.1:8080", token, 1.0, None, 0.0), "town", view, 300)

    def test_what_it_begins_with_goes_to_the_browser_in_words(self):
        made = self.made(camera={"eye": [1, 2, 3], "fov": 60}, color="rgb", width=64)
        self.assertEqual(made._asked, [0, "eye=1,2,3&fov=60&color=rgb"])
        self.assertEqual((made._server, made.cloud, made.height, made._locked), ("http://127.0.0.1:8080/", "town", 300, False))
        self.assertEqual(made.view(), {"camera": {"eye": [1, 2, 3], "fov": 60}, "color": "rgb"})
        with open(made._esm, encoding="utf-8") as file:
            self.assertIn("export default { render }", file.read())

    def test_what_the_hand_does_is_seen_and_not_sent_back(self):
        made, seen = self.made(), []
        made.observe(lambda change: seen.append(change["new"]), "camera")
        made._shown = {"cloud": "town", "camera": {"eye": [5, 5, 5]}, "method": "cone", "light": {"sun": None}}
        self.assertEqual((made.camera, made.style), ({"eye": [5, 5, 5]}, {"method": "cone", "light": {"sun": None}}))
        self.assertEqual(seen, [{"eye": [5, 5, 5]}])
        self.assertEqual(made._asked, [0, ""])

    def test_what_python_sets_is_asked_for_as_a_whole_and_again(self):
        made = self.made()
        made._shown = {"camera": {"eye": [5, 5, 5], "fov": 60}, "method": "cone", "param": {"sizePx": 3}}
        made.camera = {"eye": [1, 1, 1], "fov": 60}
        self.assertEqual(made._asked, [1, "eye=1,1,1&fov=60&method=cone&param.sizePx=3"])
        made._shown = {"camera": {"eye": [9, 9, 9], "fov": 60}, "method": "cone", "param": {"sizePx": 3}}
        made.camera = {"eye": [1, 1, 1], "fov": 60}
        self.assertEqual(made._asked[0], 2, "the same again, because the hand has been there in between")
        made.show(color="elevation", classes=[2], eye=(3, 3, 3))
        self.assertEqual(made._asked, [3, "eye=3,3,3&fov=60&method=cone&param.sizePx=3&color=elevation&classes=2"])
        made.show(method="ewa")
        self.assertEqual(made.style, {"method": "ewa", "color": "elevation", "classes": [2]})

    def test_a_token_goes_to_who_asks_and_into_no_trait(self):
        made = self.made(token="secret-secret-secret")
        self.assertTrue(made._locked)
        self.assertEqual(made.sent, [])
        for content in ({"type": "token"}, {"type": "other"}, "token", None):
            made.answers[0](made, content, [])
        self.assertEqual(made.sent, [{"type": "token", "token": "secret-secret-secret"}])
        self.assertNotIn("secret", repr({name: getattr(made, name) for name in made.traits()}))

    def test_a_browser_that_cannot_reach_the_server_gets_stills(self):
        def answer(connection):
            data = support.request_head(connection)
            while not data.endswith(b"}"):
                data += connection.recv(65536)
            asked.append(json.loads(data.partition(b"\r\n\r\n")[2]))
            connection.sendall(answers.pop(0))

        asked = []
        answers = [b"HTTP/1.1 200 OK\r\nContent-Type: image/jpeg\r\nContent-Length: 4\r\n\r\nJPEG", b"HTTP/1.1 404 x\r\nContent-Length: 0\r\n\r\n"]
        with support.lying(answer) as url:
            made = widget.make_widget(Transport(url, None, support.PATIENCE, None, 0.0), "town", {"camera": {"fov": 50}, "color": "rgb"}, 300)
            for _ in range(2):
                made.answers[0](made, {"type": "still", "width": 640, "height": 300}, [])
        self.assertEqual(made.sent, [({"type": "still"}, [b"JPEG"])])
        self.assertEqual(asked[0], {"camera": {"fov": 50}, "color": "rgb", "width": 640, "height": 300})
        self.assertIn("404", made.status)

    def test_views_by_name(self):
        made = self.made()
        made.fit()
        made.standard_view("top")
        self.assertEqual(made.sent, [{"type": "fit"}, {"type": "standard", "name": "top"}])
        self.assertRaises(ValueError, made.standard_view, "beneath")


if __name__ == "__main__":
    unittest.main()
