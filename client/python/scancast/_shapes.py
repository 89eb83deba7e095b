"""Shapes that cut (PROTOCOL.md, the word `clips`): as JSON, and as they are written in a query. Pure."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping

from ._values import number_text


def _shape_of(text: str) -> Dict[str, Any]:
    kind, colon, rest = text.strip().partition(":")
    numbers = [float(one) for one in rest.split(",")]
    if kind in ("box", "-box") and len(numbers) in (6, 7, 9):
        shape: Dict[str, Any] = {"box": {"center": numbers[:3], "size": numbers[3:6]}}
        if len(numbers) > 6:
            shape["box"]["turn"] = (numbers[6:] + [0.0, 0.0])[:3]
        if kind == "-box":
            shape["keep"] = "outside"
        return shape
    if kind == "plane" and len(numbers) == 6:
        return {"plane": {"point": numbers[:3], "normal": numbers[3:]}}
    raise ValueError(text)


def shapes_of(text: str) -> Any:
    """JSON's shapes of a query's; what is none is left as it is, for the server to judge.

    >>> shapes_of("box:5,5,2,10,4,4,30;plane:0,0,3,0,0,-1")[1]
    {'plane': {'point': [0.0, 0.0, 3.0], 'normal': [0.0, 0.0, -1.0]}}
    """
    try:
        return [_shape_of(one) for one in text.split(";")]
    except ValueError:
        return text


def _shape_text(shape: Mapping[str, Any]) -> str:
    if "plane" in shape:
        numbers: List[float] = [*shape["plane"]["point"], *shape["plane"]["normal"]]
        kind = "plane"
    else:
        turn = list(shape["box"].get("turn", []))
        while turn and not turn[-1]:
            turn.pop()
        if len(turn) == 2:
            turn.append(0)
        numbers = [*shape["box"]["center"], *shape["box"]["size"], *turn]
        kind = "-box" if shape.get("keep") == "outside" else "box"
    return f"{kind}:{','.join(number_text(one) for one in numbers)}"


def shapes_text(shapes: Any) -> str:
    """As a query writes them.

    >>> shapes_text([{"box": {"center": [5, 5, 2], "size": [10, 4, 4], "turn": [30, 0, 0]}, "keep": "outside"}])
    '-box:5,5,2,10,4,4,30'
    """
    if not isinstance(shapes, list):
        return str(shapes)
    try:
        return ";".join(_shape_text(one) for one in shapes)
    except (KeyError, TypeError, AttributeError):
        return str(shapes)
