"""The JSON document of `crosscheck check --json` and its JSON Schema, both generated from `document.toml`."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

from reports.check.checked import CheckResult

TYPES = {"number": "number", "integer": "integer", "text": "string", "flag": "boolean", "object": "object"}
OBJECTS: dict[str, dict[str, list[str]]] = tomllib.loads(
    Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
)


def check_data(found: CheckResult) -> dict[str, Any]:
    return _plain("MODEL", found)


def schema() -> dict[str, Any]:
    """The JSON Schema for one model and for the list of a folder's models."""
    model = {"$ref": "#/$defs/MODEL"}
    refused = {"type": ["string", "null"], "description": "why there is no answer"}
    entry = {"model": {"type": "string"}, "refused": refused, "found": {"anyOf": [model, {"type": "null"}]}}
    many = {"type": "array", "items": {"type": "object", "required": list(entry), "properties": entry}}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "crosscheck check --json",
        "anyOf": [model, many],
        "$defs": {name: _object(name) for name in OBJECTS},
    }


def _plain(kind: str, value: Any) -> Any:
    kind = kind.removesuffix("?")
    if value is None:
        return None
    if kind.startswith("["):
        return [_plain(kind[1:-1], item) for item in value]
    if kind == "object":
        return dict(value)
    if kind not in OBJECTS:
        return None if isinstance(value, float) and not math.isfinite(value) else value
    lookup = value.get if isinstance(value, Mapping) else lambda place: attrgetter(place)(value)
    members = OBJECTS[kind].items()
    return {name: _plain(its_kind, lookup(path[0] if path else name)) for name, (its_kind, _, *path) in members}


def _object(kind: str) -> dict[str, Any]:
    members = OBJECTS[kind].items()
    properties = {
        name: {**_type(its_kind), "description": description} for name, (its_kind, description, *_) in members
    }
    return {"type": "object", "required": list(properties), "additionalProperties": False, "properties": properties}


def _type(kind: str) -> dict[str, Any]:
    if kind.endswith("?"):
        return {"anyOf": [_type(kind[:-1]), {"type": "null"}]}
    if kind.startswith("["):
        return {"type": "array", "items": _type(kind[1:-1])}
    if "|" in kind:
        return {"anyOf": [_type(alternative) for alternative in kind.split("|")]}
    return {"$ref": f"#/$defs/{kind}"} if kind in OBJECTS else {"type": TYPES[kind]}
