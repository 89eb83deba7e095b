"""Ranges of columns (PROTOCOL.md, the word `filter`): as JSON, and as they are written in a query. Pure."""
from __future__ import annotations

import re
from typing import Any, Dict, List, Mapping
from urllib.parse import unquote

from ._values import number_text


def _range_of(text: str) -> Dict[str, Any]:
    name, colon, ends = text.rpartition(":")
    low, dots, high = ends.partition("..")
    if not (name and colon and dots) or re.search("%(?![0-9a-fA-F]{2})", name):
        raise ValueError(text)
    found: Dict[str, Any] = {"column": unquote(name)}
    if low:
        found["low"] = float(low)
    if high:
        found["high"] = float(high)
    return found


def ranges_of(text: str) -> Any:
    """JSON's ranges of a query's; what is none is left as it is, for the server to judge.

    >>> ranges_of("return_number:1..1;gps_time:3600..")[1]
    {'column': 'gps_time', 'low': 3600.0}
    """
    try:
        return [_range_of(one) for one in text.split(";")]
    except ValueError:
        return text


def _range_text(item: Mapping[str, Any]) -> str:
    name = str(item["column"]).replace("%", "%25").replace(";", "%3B")
    ends: List[str] = ["" if item.get(end) is None else number_text(item[end]) for end in ("low", "high")]
    return f"{name}:{'..'.join(ends)}"


def ranges_text(ranges: Any) -> str:
    """As a query writes them.

    >>> ranges_text([{"column": "gps_time", "low": 3600}])
    'gps_time:3600..'
    """
    if not isinstance(ranges, list):
        return str(ranges)
    try:
        return ";".join(_range_text(one) for one in ranges)
    except (KeyError, TypeError, AttributeError):
        return str(ranges)
