"""The words of a view, as they are keyword arguments. Made by make_view_words.py of protocol/openapi.json: change that, not this."""
from __future__ import annotations

from typing import Any, Dict, FrozenSet, Literal, Mapping, Optional, Sequence, Tuple, TypedDict, Union

from ._values import Box, Vector


class LightWords(TypedDict, total=False):
    # Of phong's light: what comes from everywhere. Must lie between 0 and 1.
    ambient: float
    # Of phong's light: what comes from a soft lamp over the viewer's left shoulder. Must lie between 0 and 1.
    headlight: float
    # Where the sun stands, in degrees: from north (the file's +Y) by east, and above the horizon; auto has no sun.
    sun: Union[Sequence[float], None, Literal["auto"]]
    # Of phong's light: what comes from the sun, where there is one. Must lie between 0 and 1.
    sunlight: float
    # How bright the headlight's reflections are in surfaces that face it. Must lie between 0 and 1.
    shine: float
    # How dark hollows, corners and the feet of things are drawn, with any shading; 0 is off, auto leaves it to the cloud's look. Must lie between 0 and 1.
    occlusion: Union[float, None, Literal["auto"]]
    # How dark the sun's shadows are, with any shading, where there is a sun; 0 is off. Must lie between 0 and 1.
    shadow: float


class ViewWords(TypedDict, total=False):
    # How depth becomes size.
    projection: Literal["perspective", "orthographic"]
    # Where the viewer is, in the file's coordinates.
    eye: Vector
    # The point that is looked at, in the middle of the picture.
    target: Vector
    # The direction that is up in the picture.
    up: Vector
    # World to view, 16 numbers column by column as in OpenGL; replaces eye, target and up.
    view_matrix: Sequence[float]
    # Full vertical field of view; perspective only. Must lie between 0 and 180 degrees, both excluded.
    fov: float
    # Height of what the picture shows; orthographic only. Must be above 0, in the cloud's unit.
    view_height: float
    # Nothing nearer than this is drawn. Must be above 0, in the cloud's unit.
    near: Union[float, None, Literal["auto"]]
    # Nothing farther than this is drawn. Must be above 0, in the cloud's unit.
    far: Union[float, None, Literal["auto"]]
    # Width of the picture. Must lie between 1 and 16384 px.
    width: int
    # Height of the picture. Must lie between 1 and 16384 px.
    height: int
    # How points are drawn, auto: by the method that suits the scan; one that is named starts with its own default parameters.
    method: str
    # Parameters of the method, by name.
    param: Mapping[str, Optional[Union[float, bool, str]]]
    # Where colours come from, or one colour for everything (the # may be left out); auto takes the cloud's best. rgb, elevation, classification, cloud and #rrggbb get brighter with intensity by *intensity. cir is colour infrared: near infrared as red, red as green, green as blue. visibility tells hidden points from visible ones, with method pyramid. cloud gives each cloud of several (with) a colour of its own. column:NAME is a column that the cloud keeps.
    color: str
    # How much brighter the points' own colours are drawn, by powers of two; auto leaves it to the cloud. Must lie between -3 and 3 stops.
    exposure: Union[float, None, Literal["auto"]]
    # The ramp that turns values into colours.
    colormap: str
    # The values at the two ends of the ramp; auto takes the cloud's.
    range: Union[Sequence[float], None, Literal["auto"]]
    # Draw these classifications only; none draws nothing, auto draws all.
    classes: Union[Sequence[int], None, Literal["auto"]]
    # Draw what lies inside this box only; auto draws everything.
    clip: Union[Box, None, Literal["auto"]]
    # Cut by up to eight shapes: box:CX,CY,CZ,SX,SY,SZ[,YAW[,PITCH,ROLL]] keeps what is in a turned box (in one of them at least), -box: what is outside, plane:PX,PY,PZ,NX,NY,NZ the side that its normal points to; auto cuts nothing.
    clips: Union[Sequence[Mapping[str, Any]], None, Literal["auto"]]
    # Draw only points whose values of a kept column, of intensity or of classification lie in the range, its ends included; LOW or HIGH may be left out, and up to four ranges all have to hold; auto draws everything. In a NAME, ; is written %3B and % is written %25.
    filter: Union[Sequence[Mapping[str, Any]], None, Literal["auto"]]
    # How light falls on points; auto leaves it to the method.
    shading: Union[str, None, Literal["auto"]]
    # How light falls; what is left out keeps its value.
    light: LightWords
    # Whether the cloud's mirrors show what stands before them.
    mirrors: bool
    # Whether points are drawn that the scanner saw in a mirror, and recorded behind it.
    behind_mirrors: bool
    # Whether points are drawn that are far from everything else, alone or in small groups.
    outliers: Literal["hide", "show"]
    # Show up to 64 other clouds of the same coordinate system together with this one, each moved, tinted or hidden; . is the cloud itself, auto shows it alone. A tint multiplies a cloud's own colours, and is the colour of one that has none.
    with_: Union[Sequence[Mapping[str, Any]], None, Literal["auto"]]
    # Behind the points: nothing (PNG), one colour, or a gradient from top to bottom.
    background: Union[Union[Literal["transparent"], str, Sequence[str]], None, Literal["auto"]]
    # How fine: the distance of neighbouring samples on screen down to which the cloud is refined. Must lie between 0 and 1024 px.
    detail: Union[float, None, Literal["auto"]]
    # Draw at most so many samples; auto sets no limit. Must be at least 1 sample.
    budget: Union[int, None, Literal["auto"]]
    # Anti-aliasing: so many slightly shifted pictures are averaged. Must lie between 1 and 64.
    samples: Union[int, None, Literal["auto"]]
    # Quality of the JPEG. Must lie between 1 and 100.
    quality: int
    # Colour resolution of the JPEG.
    subsampling: Literal["4:4:4", "4:2:2", "4:2:0"]


#: Where each word stands in a view as JSON.
PLACES: Dict[str, Tuple[str, ...]] = {
    "projection": ("camera", "type"),
    "eye": ("camera", "eye"),
    "target": ("camera", "target"),
    "up": ("camera", "up"),
    "view_matrix": ("camera", "viewMatrix"),
    "fov": ("camera", "fov"),
    "view_height": ("camera", "viewHeight"),
    "near": ("camera", "near"),
    "far": ("camera", "far"),
    "width": ("width",),
    "height": ("height",),
    "method": ("method",),
    "param": ("param",),
    "color": ("color",),
    "exposure": ("exposure",),
    "colormap": ("colormap",),
    "range": ("range",),
    "classes": ("classes",),
    "clip": ("clip",),
    "clips": ("clips",),
    "filter": ("filter",),
    "shading": ("shading",),
    "light": ("light",),
    "mirrors": ("mirrors",),
    "behind_mirrors": ("behindMirrors",),
    "outliers": ("outliers",),
    "with_": ("with",),
    "background": ("background",),
    "detail": ("detail",),
    "budget": ("budget",),
    "samples": ("samples",),
    "quality": ("quality",),
    "subsampling": ("subsampling",),
}

#: Words that None, or "auto", leaves to the server.
AUTOMATIC: FrozenSet[str] = frozenset({
    "background",
    "budget",
    "classes",
    "clip",
    "clips",
    "detail",
    "exposure",
    "far",
    "filter",
    "light.occlusion",
    "light.sun",
    "near",
    "range",
    "samples",
    "shading",
    "with_",
})
