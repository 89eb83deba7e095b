"""Several clouds in one view (PROTOCOL.md, the word `with`): as JSON, and as they are written in a query. Pure."""
from __future__ import annotations

from typing import Any, Dict, Mapping

from ._values import number_text


def _cloud_of(text: str) -> Dict[str, Any]:
    name, *said = text.split(",")
    cloud: Dict[str, Any] = {"cloud": name}
    for part in said:
        kind, _, value = part.partition(":")
        if kind == "shift" and value.count(":") == 2:
            cloud["shift"] = [float(one) for one in value.split(":")]
        elif kind == "tint":
            cloud["tint"] = value if value.startswith("#") else f"#{value}"
        elif part == "hidden":
            cloud["hidden"] = True
        else:
            raise ValueError(part)
    return cloud


def clouds_of(text: str) -> Any:
    """JSON's clouds of a query's; what is none is left as it is, for the server to judge.

    >>> clouds_of(".,tint:ff8800;town-2024,shift:0:0:0.12")[1]
    {'cloud': 'town-2024', 'shift': [0.0, 0.0, 0.12]}
    """
    try:
        return [_cloud_of(one) for one in text.split(";")]
    except ValueError:
        return text


def _cloud_text(cloud: Mapping[str, Any]) -> str:
    text = str(cloud["cloud"])
    shift = cloud.get("shift")
    if shift and any(shift):
        text += ",shift:" + ":".join(number_text(one) for one in shift)
    if cloud.get("tint"):
        text += ",tint:" + cloud["tint"].lstrip("#")
    return text + (",hidden" if cloud.get("hidden") else "")


def clouds_text(clouds: Any) -> str:
    """As a query writes them.

    >>> clouds_text([{"cloud": "b", "shift": [0, 0, 1.5], "tint": "#ff8800", "hidden": True}])
    'b,shift:0:0:1.5,tint:ff8800,hidden'
    """
    if not isinstance(clouds, list):
        return str(clouds)
    try:
        return ";".join(_cloud_text(one) for one in clouds)
    except (KeyError, TypeError, AttributeError):
        return str(clouds)
