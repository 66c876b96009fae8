"""Rows and answers as a store has them: JSON, and a digest by which a text out of a damaged file can be trusted."""

from __future__ import annotations

import base64
import hashlib
import json
import zlib
from dataclasses import fields
from functools import lru_cache
from typing import Any

import numpy as np

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Array

TYPES = {field.name: {"str": str, "int": int, "float": (int, float)}[str(field.type)] for field in fields(Measurement)}


def text_of_row(row: Measurement) -> str:
    return _signed(json.dumps(row.as_dict()))


@lru_cache(maxsize=8192)  # a command asks for a row more than once: what is missing, a table, several pages
def row_of(key: str, stored: Any) -> Measurement | None:
    """The row of this key; None unless it is whole and has the fields that rows have now."""
    try:
        values = json.loads(_trusted(stored))
        whole = (
            values["key"] == key
            and values.keys() == TYPES.keys()
            and all(isinstance(value, TYPES[name]) for name, value in values.items())
        )
        return Measurement(**{**values, "outcome": Outcome(values["outcome"])}) if whole else None
    except (ValueError, TypeError, KeyError):
        return None


def text_of_answer(key: str, answer: Answer) -> str:
    values = {name: value if isinstance(value, str) else _packed(value) for name, value in answer.values.items()}
    told = {"key": key, "outcome": answer.outcome, "sentence": answer.sentence, "limit": answer.limit}
    return _signed(json.dumps(told | {"values": values}))


def answer_of(key: str, stored: Any) -> Answer | None:
    """The answer to the task of this key; None unless it is whole."""
    try:
        told = json.loads(_trusted(stored))
        if told["key"] != key:
            return None
        values = {name: value if isinstance(value, str) else _unpacked(value) for name, value in told["values"].items()}
        return Answer(Outcome(told["outcome"]), told["sentence"], values, told["limit"])
    except (ValueError, TypeError, KeyError, AttributeError, zlib.error):
        return None


def _packed(array: Array) -> dict[str, Any]:
    data = np.asarray(array, dtype="<f8")
    return {"shape": data.shape, "float64": base64.b64encode(zlib.compress(data.tobytes())).decode()}


def _unpacked(value: dict[str, Any]) -> Array:
    data = zlib.decompress(base64.b64decode(value["float64"], validate=True))
    return np.frombuffer(data, dtype="<f8").reshape(value["shape"]).astype(float)


def digest(text: str) -> str:
    return hashlib.sha256(text.encode(errors="replace")).hexdigest()[:16]


def _signed(text: str) -> str:
    return f"{digest(text)} {text}"


def _trusted(stored: Any) -> str:
    """The JSON of a stored text. Raises ValueError unless its digest fits."""
    told, _, text = str(stored).partition(" ")
    if told != digest(text):
        raise ValueError("the digest does not fit")
    return text
