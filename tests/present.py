"""A check that a value is not None, for values whose type allows None."""

from __future__ import annotations

from typing import TypeVar

Value = TypeVar("Value")


def present(value: Value | None) -> Value:
    """Return the value, or fail the test if it is None."""
    assert value is not None
    return value
