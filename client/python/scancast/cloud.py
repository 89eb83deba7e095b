"""A cloud at a server: its facts, pictures of it, points of it."""
from __future__ import annotations

import base64
import html
import os
from typing import TYPE_CHECKING, Any, Dict, List, Mapping, Optional, Tuple
from urllib.parse import quote

from . import errors, words
from ._values import camel, number_text, plain
from .words import AnyView, view_json
from ._decode import decode, decode_list
from ._exports import PointsOfCloud
from ._http import Answer, Transport
from ._rasters import RastersOfCloud
from .facts import Attribute, Bounds, CloudFacts, NamedView, Photo, PickedPoint, Station
from .picture import MEDIA_TYPES, DepthPicture, Path, Picture

if TYPE_CHECKING:
    import numpy
    from typing_extensions import Unpack

    from ._view_words import ViewWords
    from .live import LiveView
    from .widget import ScancastWidget


_SMALL_ANSWER = 1 << 20  # bytes of what is no picture


class Page:
    """The server's page, in a frame of a notebook's (``cloud.page()``)."""

    def __init__(self, url: str, height: int) -> None:
        self.url = url
        self.height = height

    def __repr__(self) -> str:
        return f"Page({self.url!r})"

    def _repr_html_(self) -> str:
        return (f'<iframe src="{html.escape(self.url)}" width="100%" height="{int(self.height)}" style="border: 0" '
                f'allow="fullscreen"></iframe>')


class Cloud(PointsOfCloud, RastersOfCloud):
    """A cloud. Of its facts, those that are used most stand here; ``facts`` has all, as they were when the cloud was asked for.

    Keyword arguments of ``snapshot``, ``depth``, ``pick`` and so on are the words of a view (PROTOCOL.md, "One vocabulary for a view") in
    snake_case: ``eye=(10, 0, 2)``, ``method="ewa"``, ``param={"scale": 2}``, ``light={"sun": (135, 40)}``, ``view_height=25``. What is not given is
    the cloud's default; ``view`` gives another view to begin with.
    """

    def __init__(self, transport: Transport, facts: CloudFacts) -> None:
        self._transport = transport
        self.facts = facts

    @staticmethod
    def ask(transport: Transport, id: str) -> CloudFacts:
        return decode(CloudFacts, transport.json("GET", f"/api/v1/clouds/{quote(id, safe='')}"), "cloud")

    def __repr__(self) -> str:
        return f"<Cloud {self.id!r} at {self._transport.address.url}: {self.point_count:,} points>"

    # ---- facts

    @property
    def id(self) -> str:
        return self.facts.id

    @property
    def title(self) -> str:
        return self.facts.title

    @property
    def point_count(self) -> int:
        return self.facts.points

    @property
    def bounds(self) -> Bounds:
        return self.facts.bounds

    @property
    def crs(self) -> str:
        """The name of the coordinate reference system; empty where nobody knows it."""
        return self.facts.crs_name

    @property
    def epsg(self) -> Optional[int]:
        return self.facts.crs_epsg

    @property
    def unit(self) -> str:
        """Of x and y, such as ``metre``; empty where nobody knows it."""
        return self.facts.crs_unit

    @property
    def spacing(self) -> float:
        """Typical distance of neighbouring points."""
        return self.facts.spacing

    @property
    def attributes(self) -> List[Attribute]:
        return self.facts.attributes

    @property
    def classes(self) -> Dict[int, str]:
        """The classifications that occur, with their names."""
        return {number: self.facts.class_names.get(number, "") for number in self.facts.classes}

    def refresh(self) -> "Cloud":
        """The same cloud as it is now."""
        return Cloud(self._transport, self.ask(self._transport, self.id))

    # ---- places to look from

    def _path(self, what: str) -> str:
        return f"/api/v1/clouds/{quote(self.id, safe='')}/{what}"

    def _listed(self, what: str, given: Mapping[str, Any]) -> Any:
        spoken = words.query(words.words_text(words.view_of(given)))
        return self._transport.json("GET", self._path(what) + (f"?{spoken}" if spoken else ""))

    def views(self, **given: "Unpack[ViewWords]") -> List[NamedView]:
        """The views that show most of it, the best first. Words are those of each of them; those of a camera have no part in it."""
        return decode_list(NamedView, self._listed("views", given), "views")

    def stations(self, **given: "Unpack[ViewWords]") -> List[Station]:
        """Where the scanner stood, each with the view from there; empty where the scan does not say."""
        return decode_list(Station, self._listed("stations", given), "stations")

    def photos(self, **given: "Unpack[ViewWords]") -> List[Photo]:
        """The photos that the scan brought along, each with the view from where it was taken."""
        return decode_list(Photo, self._listed("photos", given), "photos")

    def photo(self, index: int) -> Picture:
        """One of them, as it was taken."""
        answer = self._transport.ask("GET", self._path(f"photos/{int(index)}"), accept="image/*")
        return Picture(answer.body, answer.headers.text("Content-Type"), etag=answer.headers.text("ETag"))

    # ---- pictures

    def _judged(self, refusal: errors.InvalidArgument, given: Mapping[str, Any]) -> errors.ScancastError:
        """A view as JSON is refused with less advice than a query, where a word is none: then the server is asked what it makes of that."""
        better: errors.ScancastError = refusal
        unknown = words.unknown(given)
        if unknown:
            try:
                self._listed("views", given)
            except errors.InvalidArgument as advice:
                better = advice
            except errors.ScancastError:
                pass
        for word in unknown:
            better._spell(camel(word), word)
        return better

    def _asked(self, what: str, body: Any, given: Mapping[str, Any], accept: str, known: str = "", limit: int = _SMALL_ANSWER) -> Answer:
        try:
            return self._transport.ask("POST", self._path(what), body, accept, {"If-None-Match": known} if known else None, limit)
        except errors.InvalidArgument as refusal:
            better = self._judged(refusal, given)
        raise better

    def snapshot(self, view: AnyView = None, *, format: str = "png", known: Optional[Picture] = None,
                 **given: "Unpack[ViewWords]") -> Picture:
        """A picture of any view, in full quality.

        >>> cloud.snapshot(eye=(10, 0, 2), color="elevation", width=640, height=360).array().shape   # doctest: +SKIP
        (360, 640, 3)

        `format`: ``png``, or ``jpg``. `known`: a picture of the same view from before; it is the result, too, where it is still the same.
        """
        if format not in MEDIA_TYPES:
            raise ValueError(f"format is png or jpg, not {format!r}")
        body = view_json(view, given)
        answer = self._asked("snapshot", body, given, MEDIA_TYPES[format], known.etag if known else "", _most_bytes(body))
        if answer.status == 304 and known:
            return known
        said = answer.headers
        kind = said.text("Content-Type")
        if not kind.startswith("image/"):
            raise errors.BadAnswer(f"{self._transport.address.authority} answered with {kind or 'nothing'} in place of a picture")
        return Picture(answer.body, kind, said.text("Scancast-Method"), said.text("Scancast-Method-Reason"), said.text("ETag"),
                       _count(said.get("Scancast-Damaged")), said.text("Server-Timing"), _float(said.get("Scancast-Price")))

    def save(self, path: Path, view: AnyView = None, **given: "Unpack[ViewWords]") -> Picture:
        """Writes a picture: PNG or JPEG, as the file's name says."""
        ending = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
        if ending not in MEDIA_TYPES:
            raise ValueError(f"{os.fspath(path)}: the name of a picture ends in .png or .jpg")
        picture = self.snapshot(view, format=ending, **given)
        picture.save(path)
        return picture

    def map(self, box: Sequence[float], width: int, height: int, *, crs: str = "file", format: str = "png", transparent: bool = True,
            **given: "Unpack[ViewWords]") -> Picture:
        """A map from straight above (docs/maps.md): `box` is left, bottom, right, top, in `crs` - the cloud's own coordinates, ``EPSG:3857``,
        ``CRS:84`` … -, x and y in this order in every one.

        >>> cloud.map((389400, 5819700, 389600, 5819900), 1000, 1000, color="elevation").save("map.png")   # doctest: +SKIP
        """
        if format not in MEDIA_TYPES:
            raise ValueError(f"format is png or jpg, not {format!r}")
        edges = [number_text(float(edge)) for edge in box]
        if len(edges) != 4:
            raise ValueError("box is four numbers: left, bottom, right, top")
        pairs = [("SERVICE", "WMS"), ("VERSION", "1.1.1"), ("REQUEST", "GetMap"), ("SRS", crs), ("BBOX", ",".join(edges)),
                 ("WIDTH", str(width)), ("HEIGHT", str(height)), ("FORMAT", MEDIA_TYPES[format]), ("TRANSPARENT", "TRUE" if transparent else "FALSE"),
                 ("EXCEPTIONS", "application/problem+json")]
        return self._wms(pairs, given, _most_bytes({"width": width, "height": height}))

    def legend(self, *, format: str = "png", transparent: bool = False, **given: "Unpack[ViewWords]") -> Picture:
        """What the colours of such a map mean, as a small picture.

        >>> cloud.legend(color="elevation").save("legend.png")   # doctest: +SKIP
        """
        if format not in MEDIA_TYPES:
            raise ValueError(f"format is png or jpg, not {format!r}")
        pairs = [("SERVICE", "WMS"), ("REQUEST", "GetLegendGraphic"), ("FORMAT", MEDIA_TYPES[format]), ("TRANSPARENT", "TRUE" if transparent else "FALSE"),
                 ("EXCEPTIONS", "application/problem+json")]
        return self._wms(pairs, given, _most_bytes({"width": 1024, "height": 1024}))

    def _wms(self, pairs: List[Tuple[str, str]], given: Any, limit: int) -> Picture:
        asked = self._path("wms") + "?" + words.query(pairs + words.words_text(words.view_of(given)))
        answer = self._transport.ask("GET", asked, limit=limit)
        said = answer.headers
        if not said.text("Content-Type").startswith("image/"):
            raise errors.BadAnswer(f"{self._transport.address.authority} answered with {said.text('Content-Type') or 'nothing'} in place of a picture")
        return Picture(answer.body, said.text("Content-Type"), said.text("Scancast-Method"), "", said.text("ETag"),
                       _count(said.get("Scancast-Damaged")), said.text("Server-Timing"), _float(said.get("Scancast-Price")))

    def depth_picture(self, view: AnyView = None, **given: "Unpack[ViewWords]") -> DepthPicture:
        """How far what is seen is, pixel by pixel; its bytes need no NumPy."""
        body = view_json(view, given)
        answer = self._asked("snapshot", body, given, "application/octet-stream", "", _most_bytes(body))
        said = answer.headers
        width, height = _count(said.get("Scancast-Width")), _count(said.get("Scancast-Height"))
        if not width or len(answer.body) != 4 * width * height:
            raise errors.BadAnswer(f"{self._transport.address.authority} answered with {len(answer.body)} bytes for a depth of {width} x {height}")
        return DepthPicture(answer.body, width, height, said.text("Scancast-Method"), said.text("Scancast-Method-Reason"),
                            said.text("ETag"), _count(said.get("Scancast-Damaged")))

    def depth(self, view: AnyView = None, **given: "Unpack[ViewWords]") -> "numpy.ndarray[Any, Any]":
        """The same as an array: float32 of shape (height, width), in the cloud's unit, +infinity where nothing is."""
        return self.depth_picture(view, **given).array()

    def pick(self, x: float, y: float, view: AnyView = None, **given: "Unpack[ViewWords]") -> Optional[PickedPoint]:
        """The scan's point that a pixel shows, counted from the top left corner; None for background."""
        body = {"view": view_json(view, given), "x": plain(x, "x"), "y": plain(y, "y")}
        answer = self._asked("pick", body, given, "application/json")
        told = self._transport._json_of(answer)
        return None if told is None else decode(PickedPoint, told, "point")

    # ---- live

    def live(self, view: AnyView = None, *, depth: bool = False, fps: Optional[float] = None, reconnect: bool = True, **given: "Unpack[ViewWords]") -> "LiveView":
        """A live view: words go there, pictures come back. `depth`: each frame brings its depth in cells; `fps`: frames a second that are wanted
        while it moves; `reconnect`: it comes back when the connection is lost."""
        from .live import LiveView
        return LiveView(self._transport, self.id, view_json(view, given), depth=depth, fps=fps, reconnect=reconnect,
                        judge=self._judged, given=given)

    # ---- for notebooks

    def link(self, view: AnyView = None, **given: "Unpack[ViewWords]") -> str:
        """The address of the page with this cloud and this view."""
        pairs: List[Tuple[str, str]] = [("cloud", self.id)]
        pairs += [pair for pair in words.words_text(view_json(view, given)) if pair[0] not in ("width", "height")]
        return f"{self._transport.address.url}#{words.query(pairs)}"

    def page(self, view: AnyView = None, *, page_height: int = 480, **given: "Unpack[ViewWords]") -> Page:
        """The page itself, for a notebook to show; the server has to know the notebook's address (``serve --allowed-origin``)."""
        return Page(self.link(view, **given), page_height)

    def widget(self, view: AnyView = None, *, widget_height: int = 480, **given: "Unpack[ViewWords]") -> "ScancastWidget":
        """A live view for a notebook, moved by hand, its camera and style readable and settable from Python (widget.py). Needs anywidget."""
        from .widget import make_widget
        return make_widget(self._transport, self.id, view_json(view, given), widget_height)

    def _repr_html_(self) -> str:
        """A small picture, drawn now, and the most important facts."""
        facts = self.facts
        rows = [("points", f"{facts.points:,}"), ("size", " × ".join(f"{side:,.2f}" for side in facts.bounds.size) + f" {facts.crs_unit}".rstrip()),
                ("coordinates", facts.crs_name or "unknown system"), ("attributes", ", ".join(one.name for one in facts.attributes)),
                ("format", facts.format), ("source", facts.attribution)]
        table = "".join(f"<tr><th style='text-align: left'>{name}</th><td style='text-align: left'>{html.escape(text)}</td></tr>"
                        for name, text in rows if text)
        try:
            picture = self.snapshot(width=640, height=360, format="jpg")
            shown = f'<img width="480" alt="" src="data:image/jpeg;base64,{base64.b64encode(picture.bytes).decode()}">'
        except errors.ScancastError as error:
            shown = f"<p>{html.escape(str(error))}</p>"
        return f"<div><b>{html.escape(facts.title or facts.id)}</b><br>{shown}<table>{table}</table></div>"


def _most_bytes(view: words.View) -> int:
    """Of a picture of that size."""
    width, height = view.get("width", 1280), view.get("height", 720)
    sound = all(isinstance(side, (int, float)) and 0 <= side <= 16384 for side in (width, height))
    return int(8 * width * height) + _SMALL_ANSWER if sound else _SMALL_ANSWER  # what is no size is refused


def _count(text: Optional[str]) -> int:
    return int(text) if text and text.isascii() and text.isdigit() and len(text) < 16 else 0


def _float(text: Optional[str]) -> Optional[float]:
    try:
        return float(text) if text else None
    except ValueError:
        return None
