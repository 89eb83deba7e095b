"""Points of a cloud as they are in its file: of a region, along a line, measured. What `Cloud` is made of, beside pictures."""
from __future__ import annotations

import contextlib
import json
import os
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Dict, Iterator, List, Mapping, Optional, Sequence, Tuple, TypedDict, Union

from . import errors, words
from ._http import Body, Transport
from ._values import Box, Vector, as_float, camel, plain, snake
from .picture import Path, Picture, whole_file
from .point_data import PointReader

if TYPE_CHECKING:
    import numpy
    from typing_extensions import Unpack

    from ._view_words import ViewWords
    from .facts import CloudFacts

    Array = numpy.ndarray[Any, Any]

FORMATS = {"las": "las", "ply": "ply", "csv": "csv", "txt": "txt", "xyz": "txt"}
_PIECE = 1 << 20
_LONGEST_LOSSES = 64


class RegionWords(TypedDict, total=False):
    """Which points: all of these have to hold."""

    clip: Box
    clips: Any
    classes: Sequence[int]
    filter: Any
    """Ranges of columns: ``[{"column": "gps_time", "low": 3600}]``."""
    polygon: Sequence[Sequence[float]]
    """Three corners in plan or more."""
    z: Tuple[float, float]
    """Lowest and highest."""


@dataclass(frozen=True)
class Saved:
    """What was written."""

    points: Optional[int]
    """How many, where the server says so."""
    losses: List[str]
    """What is not as the scan was, in sentences."""


@dataclass(frozen=True)
class ProfilePicture(Picture):
    """A picture of a profile, and what its edges mean: stations ``left`` and ``right``, heights ``bottom`` and ``top``, in the file's unit."""

    left: float = 0.0
    right: float = 0.0
    bottom: float = 0.0
    top: float = 0.0
    length: float = 0.0
    facts: Dict[str, Any] = field(default_factory=dict, repr=False)


class Measured(Dict[str, Any]):
    """The numbers of a measurement, by the protocol's names in snake_case, as members and as attributes: ``measured.plan_area``."""

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(f"this measurement has no {name}; it has {', '.join(self)}") from None


def _measured(told: Any) -> Any:
    if isinstance(told, dict):
        return Measured({snake(str(name)): _measured(value) for name, value in told.items()})
    return [_measured(one) for one in told] if isinstance(told, list) else told


def strings_of(text: str) -> List[str]:
    """A list of strings as a header has it (RFC 8941).

    >>> strings_of('"colours have 8 bits", "say \\\\"no\\\\""')
    ['colours have 8 bits', 'say "no"']
    """
    found: List[str] = []
    at = text.find('"')
    while at >= 0 and len(found) < _LONGEST_LOSSES:
        said, at = "", at + 1
        while at < len(text) and text[at] != '"':
            at += text[at] == "\\"
            said += text[at:at + 1]
            at += 1
        found.append(said)
        at = text.find('"', at + 1)
    return found


class PointStream:
    """Points while they come: iterate over arrays of some megabytes, or take them all with ``array()``."""

    def __init__(self, body: Body) -> None:
        self._body = body
        self._reader = PointReader(body.read)
        self.count: int = self._reader.layout.points
        self.dtype: "numpy.dtype[Any]" = self._reader.layout.dtype
        self.crs: str = self._reader.layout.crs

    @property
    def losses(self) -> List[str]:
        """What is not as the scan was; some show at the end only."""
        return losses_of(self._body)

    @property
    def profile(self) -> Dict[str, Any]:
        """Of a profile: ``length`` of the line, ``width`` of the corridor."""
        return _profile_facts(self._body.headers.text("Scancast-Profile"))

    def __iter__(self) -> "Iterator[Array]":
        yield from self._reader.chunks()
        self._end()

    def array(self) -> "Array":
        found = self._reader.array()
        self._end()
        return found

    def _end(self) -> None:
        """An answer whose last chunk does not come is not all of it."""
        if self._body.read(1):
            raise errors.BadAnswer("more points came than the head says")


def losses_of(body: Body) -> List[str]:
    return strings_of(body.headers.text("Scancast-Losses")) + strings_of(body.trailers().text("Scancast-Losses"))


def _profile_facts(text: str) -> Dict[str, Any]:
    try:
        told = json.loads(text) if text else {}
    except (ValueError, RecursionError):
        told = None
    if not isinstance(told, dict):
        raise errors.BadAnswer("the server's answer is not as the protocol has it: Scancast-Profile is no object")
    return told


def _number(told: Mapping[str, Any], name: str) -> float:
    value = told.get(name, 0.0)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise errors.BadAnswer(f"the server's answer is not as the protocol has it: Scancast-Profile's {name} is no number")
    return as_float(value)


def region_of(given: Mapping[str, Any]) -> Dict[str, Any]:
    """As JSON has it."""
    return words.view_of({name: value for name, value in given.items() if value is not None})


def _request(given: Mapping[str, Any], normals: bool, more: Mapping[str, Any]) -> Dict[str, Any]:
    region = region_of(given)
    body = {name: plain(value, name) for name, value in more.items() if value is not None}
    if region:
        body["region"] = region
    if normals:
        body["normals"] = True
    return body


def format_of(path: Path) -> str:
    ending = os.path.splitext(os.fspath(path))[1].lstrip(".").lower()
    if ending not in FORMATS:
        raise ValueError(f"{os.fspath(path)}: the name of a file of points ends in .las, .ply, .csv or .txt")
    return FORMATS[ending]


class PointsOfCloud:
    """What a cloud says of its points."""

    _transport: Transport
    facts: "CloudFacts"

    def _path(self, what: str) -> str:
        raise NotImplementedError

    def refresh(self) -> "PointsOfCloud":
        raise NotImplementedError

    def _array(self, stream: PointStream) -> "Array":
        """All of it: no more than the cloud has, or has by now, since it stays in memory."""
        if stream.count > self.facts.points:
            most = self.refresh().facts.points
            if stream.count > most:
                raise errors.BadAnswer(f"{self._transport.address.authority} says that {stream.count} points come, of a cloud that has {most}")
        return stream.array()

    def _received(self, what: str, body: Mapping[str, Any]) -> "contextlib.AbstractContextManager[Body]":
        return self._transport.stream("POST", self._path(what), body, "*/*")

    def _saved(self, path: Path, what: str, body: Mapping[str, Any]) -> Saved:
        with whole_file(path) as file, self._received(what, body) as received:
            while True:
                data = received.read(_PIECE)
                if not data:
                    break
                file.write(data)
            count = received.headers.text("Scancast-Points")
            return Saved(int(count) if count.isascii() and count.isdigit() and len(count) < 19 else None, losses_of(received))

    # ---- regions

    @contextlib.contextmanager
    def open_points(self, *, normals: bool = False, **region: "Unpack[RegionWords]") -> Iterator[PointStream]:
        """Points of a region while they come, however many there are.

        >>> with cloud.open_points(classes=[6], z=(30, 60)) as stream:        # doctest: +SKIP
        ...     sum(len(chunk) for chunk in stream)
        """
        with self._received("points", _request(region, normals, {"format": "ply"})) as body:
            yield PointStream(body)

    def points(self, *, normals: bool = False, **region: "Unpack[RegionWords]") -> "Array":
        """All points of a region, as a structured array: ``x``, ``y``, ``z`` in file coordinates and everything that was kept of them.
        Without words, all of the cloud. Impossible (``type`` is ``empty``) where there are none.

        >>> cloud.points(polygon=[(0, 0), (10, 0), (10, 10)])["z"].mean()    # doctest: +SKIP
        """
        with self.open_points(normals=normals, **region) as stream:
            return self._array(stream)

    def save_points(self, path: Path, *, normals: bool = False, **region: "Unpack[RegionWords]") -> Saved:
        """The same as a file: LAS, PLY, CSV or text, as its name says; complete or not there."""
        return self._saved(path, "points", _request(region, normals, {"format": format_of(path)}))

    # ---- profiles

    @contextlib.contextmanager
    def open_profile(self, line: Sequence[Sequence[float]], width: float = 1.0, *, normals: bool = False,
                     **region: "Unpack[RegionWords]") -> Iterator[PointStream]:
        """All points of a corridor along a line in plan, while they come; each has its ``station`` along the line and its ``offset`` from it."""
        with self._received("profile", _request(region, normals, {"format": "ply", "line": line, "width": width})) as body:
            yield PointStream(body)

    def profile(self, line: Sequence[Sequence[float]], width: float = 1.0, *, normals: bool = False, **region: "Unpack[RegionWords]") -> "Array":
        """The same as one array, in the order of the cloud file: ``numpy.sort(profile, order="station")`` goes along the line."""
        with self.open_profile(line, width, normals=normals, **region) as stream:
            return self._array(stream)

    def save_profile(self, path: Path, line: Sequence[Sequence[float]], width: float = 1.0, *, normals: bool = False,
                     **region: "Unpack[RegionWords]") -> Saved:
        """The same as a file: LAS, PLY, CSV or text, as its name says; complete or not there."""
        return self._saved(path, "profile", _request(region, normals, {"format": format_of(path), "line": line, "width": width}))

    def profile_picture(self, line: Sequence[Sequence[float]], width: float = 1.0, *, picture: Optional[Mapping[str, Any]] = None,
                        **region: "Unpack[RegionWords]") -> ProfilePicture:
        """A profile drawn: stations to the right, heights upwards. `picture`: width, height, exaggeration, point_size, color, … (PROTOCOL.md,
        "A profile")."""
        drawn = {camel(name): plain(value, name) for name, value in (picture or {}).items()}
        body = _request(region, False, {"format": "png", "line": line, "width": width, "picture": drawn or None})
        answer = self._transport.ask("POST", self._path("profile"), body, "image/png")
        said = answer.headers
        if not said.text("Content-Type").startswith("image/"):
            raise errors.BadAnswer(f"{self._transport.address.authority} answered with {said.text('Content-Type') or 'nothing'} in place of a picture")
        facts = _profile_facts(said.text("Scancast-Profile"))
        left, right, bottom, top, length = (_number(facts, name) for name in ("left", "right", "bottom", "top", "length"))
        return ProfilePicture(answer.body, said.text("Content-Type"), etag=said.text("ETag"), facts=facts, left=left, right=right, bottom=bottom,
                              top=top, length=length)

    # ---- where in the world

    def lonlat(self, points: Sequence[Sequence[float]], to: str = "lonlat") -> List[Optional[Tuple[float, float]]]:
        """File coordinates as longitudes and latitudes (WGS 84, degrees), or, ``to="file"``, the other way round; None for a place that has none.

        >>> cloud.lonlat([(389500, 5819800)])                                # doctest: +SKIP
        [(13.3715, 52.5171)]
        """
        if to not in ("lonlat", "file"):
            raise ValueError(f"to is lonlat or file, not {to!r}")
        asked = [[float(value) for value in point] for point in points]
        told = self._transport.json("POST", self._path("lonlat"), {"to": to, "points": asked})
        places = told.get("points") if isinstance(told, dict) else None
        if not isinstance(places, list) or len(places) != len(asked):
            raise errors.BadAnswer("the server's answer is not as the protocol has it: there are not as many places as were asked for")
        if not all(place is None or isinstance(place, list) and len(place) == 2 for place in places):
            raise errors.BadAnswer("the server's answer is not as the protocol has it: a place is two numbers, or null")
        return [None if place is None else (float(place[0]), float(place[1])) for place in places]

    # ---- measurements

    def measure(self, measure: str, points: Sequence[Vector], *, base: Union[float, str, None] = None, surface: Optional[str] = None,
                cell: Optional[float] = None, within: Optional[float] = None, axis: Optional[Vector] = None,
                **given: "Unpack[ViewWords]") -> Measured:
        """Lengths, angles and areas of vertices; volumes and fitted shapes of the scan's own points (PROTOCOL.md, "A measurement").

        >>> cloud.measure("distance", [(0, 0, 0), (3, 4, 0)]).length         # doctest: +SKIP
        5.0

        `measure`: distance, angle, area, volume, plane, circle, sphere or cylinder. Words of a view say which of the scan's points count:
        ``classes=[6]``, ``clip=…``.
        """
        view = words.view_of(given)
        asked = {"measure": measure, "points": points, "view": view or None, "base": base, "surface": surface, "cell": cell, "within": within,
                 "axis": axis}
        body = {name: plain(value, name) for name, value in asked.items() if value is not None}
        told = self._transport.json("POST", self._path("measure"), body)
        if not isinstance(told, dict):
            raise errors.BadAnswer("the server's answer is not as the protocol has it: a measurement is no object")
        return _measured(told)  # type: ignore[no-any-return]
