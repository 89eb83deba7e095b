#!/usr/bin/env python3
"""Writes scancast/_view_words.py of protocol/openapi.json, so that Python's words of a view are the server's.

    client/python/make_view_words.py            # in a checkout; a test fails where the file is not what this would write
"""
import json
import keyword
import os
import re
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
OPENAPI = os.path.join(HERE, "..", "..", "protocol", "openapi.json")
TARGET = os.path.join(HERE, "scancast", "_view_words.py")
NAMED = {"Vector": "Vector", "Color": "str", "Light": "LightWords"}

HEAD = '''"""The words of a view, as they are keyword arguments. Made by make_view_words.py of protocol/openapi.json: change that, not this."""
from __future__ import annotations

from typing import Any, Dict, FrozenSet, Literal, Mapping, Optional, Sequence, Tuple, TypedDict, Union

from ._values import Box, Vector
'''


def snake(name):
    name = re.sub(r"(?<=[a-z0-9])([A-Z])", lambda found: "_" + found[1].lower(), name)
    return name + "_" if keyword.iskeyword(name) else name  # with_


def is_null(schema):
    return schema.get("type") == "null"


def type_of(schema):
    """What a type checker is told of it."""
    if "$ref" in schema:
        return NAMED.get(schema["$ref"].rsplit("/", 1)[1], "Mapping[str, Any]")
    if "const" in schema:
        return f"Literal[{json.dumps(schema['const'])}]"
    if "enum" in schema:
        return f"Literal[{', '.join(json.dumps(value) for value in schema['enum'])}]"
    if "anyOf" in schema:
        kinds = list(dict.fromkeys(type_of(one) for one in schema["anyOf"] if not is_null(one)))
        return kinds[0] if len(kinds) == 1 else f"Union[{', '.join(kinds)}]"
    kind = schema.get("type")
    if isinstance(kind, list):
        kinds = [type_of({**schema, "type": one}) for one in kind if one != "null"]
        return kinds[0] if len(kinds) == 1 else f"Union[{', '.join(kinds)}]"
    if kind == "array":
        return f"Sequence[{type_of(schema.get('items', {}))}]"
    if kind == "object":
        if set(schema.get("properties", {})) == {"min", "max"}:
            return "Box"
        values = schema.get("additionalProperties")
        return f"Mapping[str, {optional(values)}]" if isinstance(values, dict) else "Mapping[str, Any]"
    return {"number": "float", "integer": "int", "boolean": "bool", "string": "str"}.get(kind, "Any")


def may_be_null(schema):
    kind = schema.get("type")
    return (isinstance(kind, list) and "null" in kind) or any(is_null(one) for one in schema.get("anyOf", ()))


def optional(schema):
    """Of what may be automatic: None says so, and so does the protocol's word."""
    return f"Optional[{type_of(schema)}]" if may_be_null(schema) else type_of(schema)


def typed(name, schemas, described):
    lines = [f"class {name}(TypedDict, total=False):"]
    for word, schema in schemas:
        if text := described.get(word):
            lines.append(f"    # {text}")
        lines.append(f"    {snake(word)}: {automatic(schema)}")
    return "\n".join(lines) + "\n"


def automatic(schema):
    return f'Union[{type_of(schema)}, None, Literal["auto"]]' if may_be_null(schema) else type_of(schema)


def module(openapi):
    """The text of the module."""
    schemas = openapi["components"]["schemas"]
    listed = [one["$ref"].rsplit("/", 1)[1] for one in openapi["paths"]["/api/v1/clouds/{id}/snapshot.jpg"]["get"]["parameters"] if "$ref" in one]
    query = [one for one in (openapi["components"]["parameters"][name] for name in listed) if one["in"] == "query"]
    described = {one["name"].replace("light.", "", 1): one.get("description", "") for one in query}
    view = {word: schema for word, schema in schemas["View"]["properties"].items() if word != "camera"}
    camera = {"projection" if word == "type" else word: schema for word, schema in schemas["Camera"]["properties"].items()}
    light = schemas["Light"]["properties"]
    words = {**camera, **view}
    if different := set(words) ^ {one["name"].split(".")[0] for one in query}:
        raise SystemExit(f"protocol/openapi.json says otherwise of a snapshot's query than of a view: {', '.join(sorted(different))}")
    described.setdefault("param", "Parameters of the method, by name.")
    described.setdefault("light", "How light falls; what is left out keeps its value.")
    places = {snake(word): (["camera", "type" if word == "projection" else word] if word in camera else [word]) for word in words}
    table = "".join(f"    {json.dumps(word)}: ({', '.join(map(json.dumps, place))}{',' * (len(place) == 1)}),\n" for word, place in places.items())
    nulls = sorted({snake(word) for word, schema in words.items() if may_be_null(schema)}
                   | {"light." + snake(word) for word, schema in light.items() if may_be_null(schema)})
    parts = [HEAD, typed("LightWords", light.items(), described), typed("ViewWords", words.items(), described),
             f"#: Where each word stands in a view as JSON.\nPLACES: Dict[str, Tuple[str, ...]] = {{\n{table}}}\n\n"
             "#: Words that None, or \"auto\", leaves to the server.\nAUTOMATIC: FrozenSet[str] = frozenset({\n"
             + "".join(f"    {json.dumps(word)},\n" for word in nulls) + "})\n"]
    return "\n\n".join(parts[:-1]) + "\n\n" + parts[-1]


def main():
    with open(OPENAPI, encoding="utf-8") as file:
        text = module(json.load(file))
    with open(TARGET, "w", encoding="utf-8") as file:
        file.write(text)
    print(f"{os.path.relpath(TARGET)}: {text.count(chr(10))} lines")


if __name__ == "__main__":
    sys.exit(main())
