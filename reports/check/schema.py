"""What `crosscheck check --json` prints: every number with its unit, as a JSON Schema."""

from __future__ import annotations

from typing import Any

TYPES = {"number": "number", "integer": "integer", "text": "string", "flag": "boolean", "object": "object"}
SETTING = """
words: text: the setting in words
step: number: s
error: number?: largest error in the measure of the tolerance; null: it gave up
reaction: number?: error of the reactions, of the largest true one of their kind
cpu: number: s of stepping
lines: [text]: lines to copy
front: flag: no other setting that was tried is both cheaper and better
"""
NOTE = """
element: text: an element of the model
reason: text: why it is left out, or what it is taken for
"""
# A line a member: its name, its type ("?": or null; "[...]": a list; a name in capitals: an object of these) and words.
FIELDS = """
name: text: the model
engine: text: what runs it
verdict: text: the answer in a sentence
duration: number: s that are judged
tolerance: number: largest error that is allowed: angles in rad, places in lengths of the mechanism
asked: flag: somebody named the tolerance
met: flag: the user's settings are within it
assumed: text: what the model does not say and was taken instead; empty if nothing
step: number: s, the user's
error: number?: largest error of the user's settings, in the measure of the tolerance; null: it gave up
cpu: number: s of stepping, at the user's settings
facts: FACTS: of the mechanism and its ideal motion
horizon: number: s, from when on neighbouring starts part exponentially; the duration if they do not
error_until_horizon: number?: largest error before that
growth: number?: how many times a small disturbance of the start has grown at the end
tenfold: number?: s in which it grows tenfold, on average while it is small; null if it does not grow
cut: flag: the judge does not know the motion beyond the duration that is told
agreement_at_start: number: of the accelerations of engine and judge at t = 0, relative
notes: [NOTE]: what is left out of the model, or taken for something else
settings: object: the engine's settings in the model, as words
errors: ERRORS: largest errors of the user's settings
judge_errors: ERRORS: of the judge itself
over_time: SERIES: errors of the user's settings at the times t
parts: PARTS: softness, step, and neither
opening: OPENING?: the joint that opens most; null where no joint can open
warnings: [text]: of the engine
tried: [SETTING]: documented settings that were run, the user's first
advised: SETTING?: the cheapest within the tolerance
next_decade: SETTING?: the cheapest with a tenth of its error
applied: APPLIED?: what --apply has written, and what it reached when it was run
"""
OBJECTS = {
    "SETTING": SETTING,
    "NOTE": NOTE,
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
""",
    "ERRORS": """
angle: number?: rad
position: number?: m
reaction: number?: of the largest true one of its kind (force or moment of a row)
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


def schema() -> dict[str, Any]:
    """A JSON Schema of one model's answer; of a folder, of a list of them with the models that were refused."""
    one = _object(FIELDS)
    refused = {"type": ["string", "null"], "description": "why there is no answer"}
    entry = {"model": {"type": "string"}, "refused": refused, "found": {"anyOf": [{"$ref": "#/$defs/MODEL"}, _NULL]}}
    many = {"type": "array", "items": {"type": "object", "required": list(entry), "properties": entry}}
    defined = {name: _object(fields) for name, fields in OBJECTS.items()} | {"MODEL": one}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "crosscheck check --json",
        "anyOf": [{"$ref": "#/$defs/MODEL"}, many],
        "$defs": defined,
    }


_NULL = {"type": "null"}


def _object(fields: str) -> dict[str, Any]:
    properties = {}
    for line in fields.strip().splitlines():
        name, kind, words = line.split(": ", 2)
        properties[name] = {**_type(kind), "description": words}
    return {"type": "object", "required": list(properties), "additionalProperties": False, "properties": properties}


def _type(kind: str) -> dict[str, Any]:
    if kind.endswith("?"):
        return {"anyOf": [_type(kind[:-1]), _NULL]}
    if kind.startswith("["):
        return {"type": "array", "items": _type(kind[1:-1])}
    if "|" in kind:
        return {"anyOf": [_type(each) for each in kind.split("|")]}
    return {"$ref": f"#/$defs/{kind}"} if kind.isupper() else {"type": TYPES[kind]}
