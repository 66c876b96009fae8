"""Bad numbers are refused where they enter, in a sentence that says which value, why, and what would be valid."""

from __future__ import annotations

from typing import Any

import numpy as np


class InvalidMechanism(ValueError):
    """A body or joint that can't be: the message says which value, why, and what would be valid."""


def require_finite(owner: str, **values: Any) -> None:
    """Raise InvalidMechanism unless every value (number or nested sequence of numbers) is finite."""
    for name, value in values.items():
        try:
            finite = bool(np.all(np.isfinite(np.asarray(value, dtype=float))))
        except (TypeError, ValueError):
            finite = False
        if not finite:
            raise InvalidMechanism(f"{owner}: {name} is {value!r}; it must be finite")


def require_positive(owner: str, **values: float) -> None:
    """Raise InvalidMechanism unless every value is a finite number above zero."""
    require_finite(owner, **values)
    for name, value in values.items():
        if not value > 0:
            raise InvalidMechanism(f"{owner}: {name} is {value!r}; it must be greater than zero")


def sample_times(owner: str, t: Any) -> np.ndarray:
    """Times (times,) [s] as an array; InvalidMechanism if one is not finite or lies before the start at 0."""
    require_finite(owner, t=t)
    times = np.atleast_1d(np.asarray(t, dtype=float))
    if times.ndim != 1:
        raise InvalidMechanism(f"{owner}: times have the shape {times.shape}; they must be one list of times")
    if times.size and times.min() < 0:
        raise InvalidMechanism(
            f"{owner}: time {float(times.min())!r} s lies before the start; times must be 0 or later"
        )
    return times
