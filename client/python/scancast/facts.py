"""What a server says of its clouds, methods, points: the protocol's members as typed fields, in snake_case (PROTOCOL.md tells of each).

`json`, where there is one, is all that the server said, newer members included. Plain values.
"""
from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Iterator, List, Optional, Tuple, Union

from .words import View

Vector3 = Tuple[float, float, float]


@dataclass(frozen=True)
class Bounds:
    """A box along the axes; as `clip` it is one, too."""

    min: Vector3
    max: Vector3

    @property
    def center(self) -> Vector3:
        return tuple((low + high) / 2 for low, high in zip(self.min, self.max))  # type: ignore[return-value]

    @property
    def size(self) -> Vector3:
        return tuple(high - low for low, high in zip(self.min, self.max))  # type: ignore[return-value]


@dataclass(frozen=True)
class Attribute:
    name: str
    range: Optional[Tuple[float, float]] = None


@dataclass(frozen=True)
class Histogram:
    """How many points have values in each of equal parts from ``low`` to ``high``."""

    low: float
    high: float
    counts: List[int]


@dataclass(frozen=True)
class Column:
    """What is kept beside the samples: ``gps_time``, extra bytes; and ``intensity``."""

    name: str
    type: str
    range: Tuple[float, float]
    description: str = ""
    drawn: bool = False
    """Whether views may be coloured and filtered by it."""
    usual: Optional[Tuple[float, float]] = None
    """The 1st and the 99th percentile."""
    histogram: Optional[Histogram] = None


@dataclass(frozen=True)
class Mirror:
    center: Vector3
    normal: Vector3
    up: Vector3
    width: float
    height: float
    tint: str


@dataclass(frozen=True)
class Live:
    """How the source of a cloud that changes is doing."""

    state: str
    shown: int
    skipped: int
    failed: int
    error: str = ""


@dataclass(frozen=True)
class LookView:
    name: str
    inside: bool
    camera: Dict[str, Any]


@dataclass(frozen=True)
class Look:
    """How a cloud is shown when nobody says anything."""

    kind: str
    reason: str
    up: Vector3
    bounds: Bounds
    noise: float
    style: Dict[str, Any]
    views: List[LookView]
    outline: List[Vector3] = field(default_factory=list)


@dataclass(frozen=True)
class Crs:
    """What coordinates are in, as far as it is known."""

    name: str = ""
    epsg: Optional[int] = None
    unit: str = ""
    vertical_name: str = ""
    vertical_epsg: Optional[int] = None
    vertical_unit: str = ""


@dataclass(frozen=True)
class CloudFacts:
    """A cloud, as the server describes it."""

    id: str
    title: str
    state: str
    format: str
    revision: str
    points: int
    dropped_points: int
    bounds: Bounds
    origin: Vector3
    spacing: float
    attributes: List[Attribute]
    constant: Dict[str, Any]
    notes: List[str]
    stations: int
    photos: int
    classes: List[int]
    class_names: Dict[int, str]
    crs_name: str
    crs_unit: str
    mirrors: List[Mirror]
    surfels: bool
    bytes_resident: int
    columns: List[Column]
    view: View
    look: Optional[Look] = None
    live: Optional[Live] = None
    stage: str = ""
    progress: Optional[float] = None
    error: str = ""
    attribution: str = ""
    recorded: str = ""
    crs_wkt: str = ""
    crs_epsg: Optional[int] = None
    crs: Optional[Crs] = None
    class_counts: Dict[int, int] = field(default_factory=dict)
    class_colors: Dict[int, str] = field(default_factory=dict)
    json: Dict[str, Any] = field(default_factory=dict, repr=False)


@dataclass(frozen=True)
class PendingCloud:
    """A cloud that cannot be looked at: not yet, or never."""

    id: str
    title: str
    state: str
    stage: str = ""
    progress: Optional[float] = None
    error: str = ""
    live: Optional[Live] = None


@dataclass(frozen=True)
class NamedView:
    """A view that shows a cloud well. It can be given wherever a view can: ``cloud.snapshot(cloud.views()[0])``."""

    name: str
    inside: bool
    view: View


@dataclass(frozen=True)
class Station:
    """Where the scanner stood. It can be given as a view."""

    name: str
    position: Vector3
    points: int
    photos: List[int]
    view: View
    forwards: Optional[Vector3] = None


@dataclass(frozen=True)
class PhotoAngles:
    across: Optional[float] = None
    down: Optional[float] = None


@dataclass(frozen=True)
class PhotoStation:
    index: int
    name: str


@dataclass(frozen=True)
class Pose:
    position: Vector3
    forwards: Vector3
    up: Vector3


@dataclass(frozen=True)
class Photo:
    """A photo that the scan brought along; ``cloud.photo(photo.index)`` is itself. With a pose it can be given as a view."""

    index: int
    name: str
    media_type: str
    projection: str
    bytes: int
    href: str
    width: Optional[int] = None
    height: Optional[int] = None
    angles: Optional[PhotoAngles] = None
    station: Optional[PhotoStation] = None
    pose: Optional[Pose] = None
    view: Optional[View] = None


@dataclass(frozen=True)
class Parameter:
    """Of a method: ``param={parameter.name: …}``."""

    name: str
    type: str
    default: Any
    meaning: str
    min: Optional[float] = None
    max: Optional[float] = None
    choices: List[str] = field(default_factory=list)
    unit: str = ""


@dataclass(frozen=True)
class Method:
    name: str
    title: str
    summary: str
    source: str
    needs: List[str]
    default_detail: float
    default_shading: str
    parameters: List[Parameter]


@dataclass(frozen=True)
class Methods:
    """All rendering methods, by number or by name, and what else a style may name."""

    methods: List[Method]
    colors: List[str]
    colormaps: List[str]
    shadings: List[str]
    ramps: Dict[str, List[str]] = field(default_factory=dict)
    """Of each colour map the colours at even steps, from the least value to the greatest."""

    def __iter__(self) -> Iterator[Method]:
        return iter(self.methods)

    def __len__(self) -> int:
        return len(self.methods)

    def __getitem__(self, which: Union[int, str]) -> Method:
        if isinstance(which, int):
            return self.methods[which]
        for method in self.methods:
            if method.name == which:
                return method
        raise KeyError(which)


@dataclass(frozen=True)
class PickedPoint:
    """A point of the scan, in the file's own coordinates."""

    position: Vector3
    precision: Vector3
    depth: float
    distance: float
    rgb: Optional[Tuple[int, int, int]] = None
    intensity: Optional[int] = None
    classification: Optional[int] = None
    class_name: str = ""
    normal: Optional[Vector3] = None
    radius: Optional[float] = None
    exact: Optional[bool] = None
    surface: Optional[Vector3] = None  # the place under the pixel itself, between the points
    crs: Optional[Crs] = None
    cloud: str = ""  # of a view of several (with_): whose point it is
    shift: Optional[Vector3] = None  # and by which it is seen elsewhere
    attributes: Dict[str, Any] = field(default_factory=dict)
    json: Dict[str, Any] = field(default_factory=dict, repr=False)
