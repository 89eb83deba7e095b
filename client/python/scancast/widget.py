"""A live view that a notebook moves by hand: the server's own ``<scancast-view>``, kept the same as a Python object, by anywidget.

The picture goes from the server to the browser, not through Python: the server has to know the notebook's address (``scancast serve
--allowed-origin http://localhost:8888``). Where a browser cannot reach it, Python draws still pictures, which follow what Python sets.
"""
from __future__ import annotations

import functools
import os
import pathlib
from typing import TYPE_CHECKING, Any, Dict, Mapping, Optional, Protocol
from urllib.parse import quote

from . import errors, words
from ._http import Transport

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._view_words import ViewWords

STANDARD_VIEWS = ("fit", "first", "top", "front", "side", "back", "left", "bottom")


class ScancastWidget(Protocol):
    """What ``Cloud.widget()`` makes: an anywidget.AnyWidget with these traits and methods. ``widget.observe(callback, "camera")`` tells of changes."""

    cloud: str
    """The id of the cloud that is shown."""
    camera: Dict[str, Any]
    """As in a view as JSON; may be set, and changes with the hand."""
    style: Dict[str, Any]
    """Everything else of a view: method, color, …; may be set."""
    controls: str
    """What dragging does: ``orbit``, ``look`` around, or ``none``."""
    height: int
    """Of the cell, in CSS pixels."""
    picked: Optional[Dict[str, Any]]
    """The point that was clicked last, as PROTOCOL.md tells of a picked point; None for background."""
    status: str
    """What is wrong, for people; empty where nothing is."""

    def show(self, view: words.AnyView = None, **given: "Unpack[ViewWords]") -> None:
        """Changes these words; what is not given stays."""

    def view(self) -> words.View:
        """What is shown, camera and style, as JSON: ``cloud.snapshot(widget.view())``."""

    def fit(self) -> None:
        """All of the cloud."""

    def standard_view(self, name: str) -> None:
        """``top``, ``front``, ``side``, ``back``, ``left``, ``bottom``, ``first``, ``fit``."""

    def observe(self, handler: Any, names: Any = ...) -> None:
        """Of traitlets."""


@functools.lru_cache(maxsize=1)
def _widget_class() -> Any:
    try:
        import anywidget
        import traitlets
    except ImportError:
        raise errors.MissingLibrary("a live view in a notebook needs anywidget, which is not installed here: pip install anywidget; "
                                    "cloud.page() shows the server's page without it") from None

    class Widget(anywidget.AnyWidget):  # type: ignore[misc]
        _esm = pathlib.Path(os.path.join(os.path.dirname(os.path.abspath(__file__)), "widget.js"))
        _server = traitlets.Unicode().tag(sync=True)
        _locked = traitlets.Bool(False).tag(sync=True)
        _asked = traitlets.List([0, ""]).tag(sync=True)
        _shown = traitlets.Dict().tag(sync=True)
        cloud = traitlets.Unicode().tag(sync=True)
        controls = traitlets.Enum(["orbit", "look", "none"], default_value="orbit").tag(sync=True)
        height = traitlets.Int(480, min=120).tag(sync=True)
        picked = traitlets.Dict(default_value=None, allow_none=True).tag(sync=True)
        status = traitlets.Unicode("").tag(sync=True)
        camera = traitlets.Dict()
        style = traitlets.Dict()

        def __init__(self, transport: Transport, cloud: str, view: Mapping[str, Any], height: int) -> None:
            self._transport = transport
            self._told = False  # what changes now is what the browser said
            rest = {name: value for name, value in view.items() if name not in ("camera", "width", "height")}
            camera = dict(view.get("camera", {}))
            token = transport.token()
            super().__init__(_server=transport.address.url, _locked=token is not None, cloud=cloud, height=height,
                             _asked=[0, _spoken(camera, rest)])
            self._told = True
            self.camera, self.style = camera, rest
            self._told = False
            self.observe(self._browser_said, "_shown")
            self.observe(self._python_said, ["camera", "style"])
            self.on_msg(self._answer)

        def _browser_said(self, change: Any) -> None:
            shown = {name: value for name, value in change["new"].items() if name not in ("cloud", "width", "height")}
            self._told = True
            try:
                self.camera = shown.pop("camera", {})
                self.style = shown
            finally:
                self._told = False

        def _python_said(self, _: Any) -> None:
            if not self._told:
                self._asked = [self._asked[0] + 1, _spoken(self.camera, self.style)]

        def _answer(self, _: Any, content: Any, buffers: Any) -> None:
            kind = content.get("type") if isinstance(content, dict) else None
            if kind == "token":
                token = self._transport.token()
                if token is not None:
                    self.send({"type": "token", "token": token})
            elif kind == "still":
                self._draw(content.get("width"), content.get("height"))

        def _draw(self, width: Any, height: Any) -> None:
            """A picture for a browser that cannot reach the server."""
            view = {**self.view(), "width": width, "height": height}
            try:
                answer = self._transport.ask("POST", f"/api/v1/clouds/{quote(self.cloud, safe='')}/snapshot", view, "image/jpeg")
            except errors.ScancastError as error:
                self.status = str(error)
            else:
                self.send({"type": "still"}, buffers=[answer.body])

        def view(self) -> words.View:
            return {**self.style, "camera": self.camera} if self.camera else dict(self.style)

        def show(self, view: words.AnyView = None, **given: Any) -> None:
            wanted = words.changed(self.view(), words.view_json(view, given))
            camera = wanted.pop("camera", {})
            self._told = True
            try:
                self.camera = camera
                self.style = {name: value for name, value in wanted.items() if name not in ("cloud", "width", "height")}
            finally:
                self._told = False
            self._python_said(None)

        def fit(self) -> None:
            self.send({"type": "fit"})

        def standard_view(self, name: str) -> None:
            if name not in STANDARD_VIEWS:
                raise ValueError(f"{name} is no standard view; {', '.join(STANDARD_VIEWS)} are")
            self.send({"type": "standard", "name": name})

    return Widget


def _spoken(camera: Mapping[str, Any], style: Mapping[str, Any]) -> str:
    return words.query(words.words_text({**({"camera": dict(camera)} if camera else {}), **style}))


def make_widget(transport: Transport, cloud: str, view: Mapping[str, Any], height: int) -> ScancastWidget:
    """MissingLibrary without anywidget."""
    return _widget_class()(transport, cloud, view, height)  # type: ignore[no-any-return]
