"""A server's JSON → dataclasses, whose fields are the protocol's members in snake_case. Pure.

A member that is not what the field says is a BadAnswer that names it; one that is left out has the field's default; members that no field
knows stay in `json`, where the class has that.
"""
from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any, Dict, List, Tuple, Type, TypeVar, Union, get_args, get_origin, get_type_hints

from ._values import as_float, camel
from .errors import BadAnswer

T = TypeVar("T")


@functools.lru_cache(maxsize=None)
def _fields(kind: type) -> List[Tuple[dataclasses.Field, Any]]:  # type: ignore[type-arg]
    hints = get_type_hints(kind)
    return [(field, hints[field.name]) for field in dataclasses.fields(kind)]


def _wrong(what: str, expected: str) -> BadAnswer:
    return BadAnswer(f"the server's answer is not as the protocol has it: {what} is no {expected}")


def _value(kind: Any, value: Any, what: str) -> Any:
    origin = get_origin(kind)
    if kind is Any:
        return value
    if origin is Union:  # Optional
        if value is None:
            return None
        return _value(next(one for one in get_args(kind) if one is not type(None)), value, what)
    if origin is tuple:
        items = get_args(kind)
        if not isinstance(value, list) or len(value) != len(items):
            raise _wrong(what, f"list of {len(items)}")
        return tuple(_value(one, item, f"{what}[{i}]") for i, (one, item) in enumerate(zip(items, value)))
    if origin is list:
        if not isinstance(value, list):
            raise _wrong(what, "list")
        return [_value(get_args(kind)[0], item, f"{what}[{i}]") for i, item in enumerate(value)]
    if origin is dict:
        if not isinstance(value, dict):
            raise _wrong(what, "object")
        key, item = get_args(kind)
        try:
            return {key(name): _value(item, one, f"{what}.{name}") for name, one in value.items()}
        except ValueError as error:
            raise error if isinstance(error, BadAnswer) else _wrong(what, f"object with names that are {key.__name__}") from None
    if dataclasses.is_dataclass(kind):
        return decode(kind, value, what)
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        number = as_float(value)
        if math.isinf(number):
            raise _wrong(what, "number")
        return number
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise _wrong(what, kind.__name__)
    return value


def decode(kind: Type[T], told: Any, what: str) -> T:
    """`told` as one of `kind`; `what` names it in errors."""
    if not isinstance(told, dict):
        raise _wrong(what, "object")
    values: Dict[str, Any] = {}
    for field, hint in _fields(kind):  # type: ignore[arg-type]
        if field.name == "json":
            values["json"] = told
            continue
        key = camel(field.name)
        if key in told:
            values[field.name] = _value(hint, told[key], f"{what}.{key}")
        elif field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING:
            raise BadAnswer(f"the server's answer is not as the protocol has it: {what}.{key} is missing")
    return kind(**values)


def decode_list(kind: Type[T], told: Any, member: str) -> List[T]:
    """The list that `told` has under `member`."""
    if not isinstance(told, dict) or not isinstance(told.get(member), list):
        raise _wrong(member, "list")
    return [decode(kind, one, f"{member}[{i}]") for i, one in enumerate(told[member])]
