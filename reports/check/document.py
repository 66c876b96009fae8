"""The JSON document of `crosscheck check --json` and its JSON Schema, both generated from the table OBJECTS."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from operator import attrgetter
from typing import Any

from reports.check.checked import CheckResult

TYPES = {"number": "number", "integer": "integer", "text": "string", "flag": "boolean", "object": "object"}
# A line describes a member as "name: type: description" or "name = attribute path: type: description". A type ends in
# "?" if the value may be null. A number that is not finite is null. "[...]" is a list. Capitals name an object.
OBJECTS = {
    "MODEL": """
name: text: the model
engine = reading.model.engine: text: what runs it
verdict: text: the answer in a sentence
duration: number: s that are judged
tolerance: number: largest error that is allowed: angles in rad, places in lengths of the mechanism
asked = has_tolerance: flag: the user gave the tolerance
met: flag: the user's settings are within it
assumed = reading.model.assumed: text: what the model does not say and was taken instead; empty if nothing
step = reading.model.dt: number: s, the user's
error = own_errors.largest: number?: largest error of the user's settings, as the tolerance counts it; null: it gave up
cpu = own.stepping: number: s of stepping, at the user's settings
facts: FACTS: of the mechanism and its ideal motion
horizon = judge.horizon: number: s, from when on neighbouring starts part exponentially; the duration if they do not
error_until_horizon: number?: largest error before that
growth = judge.grown: number?: how many times a small disturbance of the start has grown at the end
tenfold = judge.tenfold: number?: s in which it grows tenfold, on average while it is small; null if it does not grow
cut = judge.cut: flag: the judge does not know the motion beyond the duration that is told
agreement_at_start = agreement: number: of the accelerations of engine and judge at t = 0, relative
notes = reading.notes: [NOTE]: what is left out of the model, or taken for something else
settings = reading.model.settings: object: the engine's settings in the model, as words
errors = own_errors.worst: ERRORS: largest errors of the user's settings
judge_errors = judge_errors.worst: ERRORS: of the judge itself
over_time = own_errors.over_time: SERIES: errors of the user's settings at the times t
parts: PARTS: softness, step, and neither
opening = opens: OPENING?: the joint that opens most; null where no joint can open
warnings = own.warnings: [text]: of the engine
tried = table: [SETTING]: documented settings that were run, the user's first
advised: SETTING?: the cheapest within the tolerance
next_decade = decade: SETTING?: the cheapest with a tenth of its error
applied: APPLIED?: what --apply has written, and what it reached when it was run
""",
    "SETTING": """
words = change.words: text: the setting in words
step = change.dt: number: s
error: number?: largest error in the measure of the tolerance; null: it gave up
reaction: number?: error of the reactions, of the largest true one of their kind
cpu = cost: number: s of stepping
lines = change.lines: [text]: lines to copy
front: flag: no other setting that was tried is both cheaper and better
""",
    "NOTE": """
element: text: an element of the model
reason: text: why it is left out, or what it is taken for
""",
    "FACTS": """
bodies: integer: count
joints: integer: count
forces: integer: count of force elements
rows: integer: count of scalar constraints
freedoms: [integer]: of configuration, of velocity
redundant: integer: rows that follow from others
undetermined: [text]: rows whose reactions rigid bodies alone do not tell
singular: [[number]]: near-singular positions: s, and the least singular value of the rows beside the largest
dead_centres: [[number|text]]: s, and the body that turns back
fastest_rotation: number: rad/s
stiffest_mode: number?: rad/s or 1/s, of small motions at the start
length: number: m
time: number: s
locked: flag: the joints leave no freedom, and none prescribes a motion
locking_welds: [text]: of a locked mechanism: welds that as hinges would leave a freedom
""",
    "ERRORS": """
angle: number?: rad
position: number?: m
reaction: number?: of the largest true one of its kind (force or moment of a row), if that is more than rounding
energy: number?: kinetic, and potential of gravity and springs, of the largest kinetic one
""",
    "SERIES": """
t: [number]: s
angle: [number?]: rad
position: [number?]: m
reaction: [number?]: of the largest true one of its kind
energy: [number?]: of the largest kinetic one
""",
    "PARTS": """
softness: number?: error of the motion that the engine declares for its joints; null: it declares none
step: number?: how far the user's run is off that motion
rest: number?: what of it is left at the smallest step that was tried
smallest: number?: s, that step
falling: flag: it was still falling there, so there is no sign of a third part
divided: flag: the engine declares a law of its joints in which no step takes part
""",
    "OPENING": """
row: text: the row of a joint
gap: number: in the unit
unit: text: m or rad
t: number: s
""",
    "APPLIED": """
file: text: what was written
words: text: the settings in it
error: number?: largest error of a run of that file
cpu: number: s of stepping
notes: [text]: what was done to a script, and what did not take
""",
}


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


def _members(kind: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield (name, attribute path, type, description) for the members of an object in OBJECTS."""
    for line in OBJECTS[kind].strip().splitlines():
        name, its_kind, description = line.split(": ", 2)
        name, _, path = name.partition(" = ")
        yield name, path or name, its_kind, description


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
    return {name: _plain(its_kind, lookup(place)) for name, place, its_kind, _ in _members(kind)}


def _object(kind: str) -> dict[str, Any]:
    properties = {
        name: {**_type(its_kind), "description": description} for name, _, its_kind, description in _members(kind)
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
