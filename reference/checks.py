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
