"""Values as Python has them and as the protocol writes them: names, numbers, boxes. Pure."""
from __future__ import annotations

import math
import re
from typing import Any, Dict, Mapping, Sequence, Tuple, Union

Vector = Sequence[float]
"""Three numbers: a list, a tuple, a NumPy array."""

Box = Union[Sequence[float], Sequence[Vector], Mapping[str, Vector]]
"""A box along the axes: six numbers, two corners, or {"min": …, "max": …}."""


def camel(name: str) -> str:
    """Python's name in the protocol's spelling.

    >>> camel("view_height")
    'viewHeight'
    """
    return re.sub(r"_([a-z0-9])", lambda found: found.group(1).upper(), name)


def snake(name: str) -> str:
    """The protocol's name in Python's spelling.

    >>> snake("behindMirrors"), snake("light.sunlight")
    ('behind_mirrors', 'light.sunlight')
    """
    return re.sub(r"(?<=[a-z0-9])([A-Z])", lambda found: "_" + found.group(1).lower(), name)


def plain(value: Any, name: str) -> Any:
    """A value as JSON has it: lists of tuples and arrays, numbers that are finite. ValueError names what is none.

    >>> plain((1, 2.5), "eye")
    [1, 2.5]
    """
    if hasattr(value, "tolist") and not isinstance(value, (bytes, bytearray, memoryview)):  # an array or a number of NumPy's
        value = value.tolist()
    if value is None or isinstance(value, (str, bool, int)):
        return value
    if isinstance(value, float):
        if not math.isfinite(value):
            raise ValueError(f"{name}: {value} is no number that can be asked for")
        return value
    if isinstance(value, Mapping):
        return {str(key): plain(item, f"{name}.{key}") for key, item in value.items()}
    if hasattr(value, "min") and hasattr(value, "max") and not callable(value.min):  # Bounds
        return {"min": plain(value.min, name), "max": plain(value.max, name)}
    if isinstance(value, (list, tuple, set, frozenset, range)):
        return [plain(item, name) for item in (sorted(value) if isinstance(value, (set, frozenset)) else value)]
    raise ValueError(f"{name}: {type(value).__name__} is no value of a view; numbers, text, lists and dictionaries are")


def box(value: Any) -> Any:
    """{"min", "max"} of whatever says so; anything else as it is, for the server to judge.

    >>> box([0, 0, 0, 10, 10, 5])
    {'min': [0, 0, 0], 'max': [10, 10, 5]}
    """
    if isinstance(value, list) and len(value) == 6 and not any(isinstance(item, list) for item in value):
        return {"min": value[:3], "max": value[3:]}
    if isinstance(value, list) and len(value) == 2 and all(isinstance(item, list) for item in value):
        return {"min": value[0], "max": value[1]}
    return value


def shown(text: str) -> str:
    """Text of a server's as it may stand on a terminal or in a log: what either would obey is written as an escape.

    >>> shown("Straße \\x1b[31m")
    'Straße \\\\x1b[31m'
    """
    return text if text.isprintable() else "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def as_float(value: Union[int, float]) -> float:
    """A number of a server's; JSON has integers that no float can hold, which are infinite then.

    >>> as_float(3), as_float(-10**400)
    (3.0, -inf)
    """
    try:
        return float(value)
    except OverflowError:
        return math.inf if value > 0 else -math.inf


def number_text(value: Union[int, float]) -> str:
    """As short as it reads back exactly.

    >>> number_text(10.0), number_text(0.1)
    ('10', '0.1')
    """
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return repr(value)


def merged(base: Mapping[str, Any], more: Mapping[str, Any], deep: Tuple[str, ...] = ("camera", "light", "param")) -> Dict[str, Any]:
    """`base` with what `more` says; of `deep` members, their members."""
    result = dict(base)
    for key, value in more.items():
        both = key in deep and isinstance(value, Mapping) and isinstance(result.get(key), Mapping)
        result[key] = {**result[key], **value} if both else value
    return result
