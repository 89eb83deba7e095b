"""Keyword arguments ↔ a view as JSON ↔ its words in a link. Pure; what the words are stands in _view_words.py.

Python's names are the protocol's in snake_case: ``view_height`` is ``viewHeight``; ``with``, which Python has another meaning for, is ``with_``. Names that this version does not know are passed on
as they are: the server may be newer, and tells what it does not know either.
"""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Optional, Protocol, Tuple, Union
from urllib.parse import quote

from ._ranges import ranges_of, ranges_text
from ._clouds import clouds_of, clouds_text
from ._shapes import shapes_of, shapes_text
from ._values import box, camel, merged, number_text, plain
from ._view_words import AUTOMATIC, PLACES

View = Dict[str, Any]
"""A view as JSON, or part of one: PROTOCOL.md, "A view as JSON"."""

_DEFAULT_BACKGROUND = "3a424e,16191e"


def _automatic(name: str, value: Any) -> Any:
    return None if value == "auto" and name in AUTOMATIC else value


def _nested(name: str, value: Any) -> Any:
    """Of `light` and `param`: names within them, and what is automatic."""
    if not isinstance(value, dict):
        return value
    return {camel(key): _automatic(f"{name}.{key}", item) for key, item in value.items()}


def view_of(words: Mapping[str, Any], base: Optional[Mapping[str, Any]] = None) -> View:
    """The view, as JSON, that these words ask for; with `base`, a view as JSON, what they change of it.

    >>> view_of({"eye": (0, -10, 2), "view_height": 25, "param": {"sizePx": 5}, "classes": "auto"})
    {'camera': {'eye': [0, -10, 2], 'viewHeight': 25}, 'param': {'sizePx': 5}, 'classes': None}

    ValueError: a value that JSON cannot have, such as a NaN, with its name.
    """
    view: View = {}
    for name, given in words.items():
        value = _automatic(name, plain(given, name))
        if name in ("light", "param"):
            value = _nested(name, value)
        elif name == "clip":
            value = box(value)
        elif name == "clips" and isinstance(value, str) and value != "auto":
            value = shapes_of(value)
        elif name == "filter" and isinstance(value, str) and value != "auto":
            value = ranges_of(value)
        elif name == "with_" and isinstance(value, str):
            value = clouds_of(value)
        elif name == "classes" and value == "none":
            value = []
        place = PLACES.get(name, (camel(name),))
        if len(place) == 2:
            view.setdefault(place[0], {})[place[1]] = value
        else:
            view[place[0]] = value
    return changed(base, view) if base is not None else view


def changed(base: Mapping[str, Any], more: View) -> View:
    """What two views say, the second one's word first."""
    result = dict(base)
    camera = more.get("camera", {})
    if isinstance(base.get("camera"), Mapping):
        kept = dict(base["camera"])
        if "viewMatrix" in camera:
            gone: Tuple[str, ...] = ("eye", "target", "up")
        elif {"eye", "target", "up"} & set(camera):
            gone = ("viewMatrix",)
        else:
            gone = ()
        if camera.get("type", kept.get("type")) != kept.get("type"):
            gone += ("fov", "viewHeight")
        result["camera"] = {key: value for key, value in kept.items() if key not in gone}
    if more.get("method", base.get("method")) != base.get("method"):
        result.pop("param", None)  # those of another method
    return merged(result, more)


def unknown(words: Mapping[str, Any]) -> List[str]:
    """Words that this version does not know.

    >>> unknown({"eye": (0, 0, 1), "fvo": 60})
    ['fvo']
    """
    return [name for name in words if name not in PLACES]


def _text(value: Any) -> str:
    if value is None:
        return "auto"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return number_text(value)
    if isinstance(value, dict) and set(value) == {"min", "max"}:
        value = [*value["min"], *value["max"]]
    if isinstance(value, list):
        return ",".join(_text(item) for item in value)
    return str(value)


def words_text(view: Mapping[str, Any]) -> List[Tuple[str, str]]:
    """A view as JSON, in the words of a query or of a page's link.

    >>> words_text({"camera": {"eye": [0, -10, 2], "type": "perspective"}, "light": {"sun": [135, 40]}, "classes": []})
    [('eye', '0,-10,2'), ('projection', 'perspective'), ('light.sun', '135,40'), ('classes', 'none')]
    """
    said: List[Tuple[str, str]] = []
    for key, value in view.items():
        if key == "camera":
            said += [("projection" if name == "type" else name, _text(item)) for name, item in value.items()]
        elif key in ("light", "param") and isinstance(value, Mapping):
            said += [(f"{key}.{name}", _text(item)) for name, item in value.items() if item is not None or key == "light"]
        elif key == "classes" and value == []:
            said.append((key, "none"))
        elif key == "clips" and value is not None:
            said.append((key, shapes_text(value)))
        elif key == "filter" and value:
            said.append((key, ranges_text(value)))
        elif key == "with" and value is not None:
            said.append((key, clouds_text(value)))
        elif key == "background" and value is None:
            said.append((key, _DEFAULT_BACKGROUND))
        else:
            said.append((key, _text(value)))
    return said


def query(pairs: List[Tuple[str, str]]) -> str:
    """As it stands behind ``?`` or ``#``.

    >>> query([("eye", "0,-10,2"), ("color", "#ff0000")])
    'eye=0,-10,2&color=%23ff0000'
    """
    return "&".join(f"{quote(word, safe='')}={quote(text, safe=',:;*')}" for word, text in pairs)


class HasView(Protocol):
    """What has a view: a NamedView, a Station, a Photo with a pose."""

    @property
    def view(self) -> Optional[View]: ...


AnyView = Union[None, Mapping[str, Any], HasView]
"""What pictures begin with: nothing - the cloud's default view -, a view as JSON, or what has one."""


def view_json(view: AnyView, given: Mapping[str, Any]) -> View:
    """The view as JSON, and what keyword arguments change of it."""
    base = view if view is None or isinstance(view, Mapping) else view.view
    if base is None and view is not None:
        raise ValueError(f"{view} has no view: nobody knows where it was taken")
    if isinstance(base, Mapping):
        base = {name: value for name, value in base.items() if name != "cloud"}
    return view_of(given, base)
