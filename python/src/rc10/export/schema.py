"""JSON Schemas of what an MCAP file of ours has, made from the messages themselves."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

from rc10 import lcm_types

if TYPE_CHECKING:
    from collections.abc import Mapping

_JSON_TYPES = {
    "boolean": "boolean",
    "string": "string",
    "float": "number",
    "double": "number",
    "int8_t": "integer",
    "int16_t": "integer",
    "int32_t": "integer",
    "int64_t": "integer",
}


def schema_of(kind: Any, without: tuple[str, ...] = ()) -> dict[str, Any]:
    """Returns the JSON Schema of an LCM type as plain() writes it, less some of its members."""
    properties = {}
    for name, kind_name, dimensions in zip(kind.__slots__, kind.__typenames__, kind.__dimensions__):
        if name not in without:
            properties[name] = _member(kind_name, dimensions)
    return {"type": "object", "properties": properties}


def numbers_schema(names: Mapping[str, float | None]) -> dict[str, Any]:
    """Returns the JSON Schema of an object with numbers of these names."""
    return {"type": "object", "properties": {name: {"type": "number"} for name in names}}


def encoded(schema: Mapping[str, Any]) -> bytes:
    """Returns a schema as it stands in a file."""
    return json.dumps(schema).encode()


def _member(kind_name: str, dimensions: Any) -> dict[str, Any]:
    if kind_name == "byte":  # plain() writes them as text
        return {"type": "string"}
    if kind_name in _JSON_TYPES:
        schema: dict[str, Any] = {"type": _JSON_TYPES[kind_name]}
    else:
        schema = schema_of(getattr(lcm_types, kind_name.rpartition(".")[2]))
    return {"type": "array", "items": schema} if dimensions else schema
