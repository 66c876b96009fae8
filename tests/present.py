"""What may be missing by its type, and by the test's own premise is there."""

from __future__ import annotations

from typing import TypeVar

Value = TypeVar("Value")


def present(value: Value | None) -> Value:
    """The value; a test that supposes it fails if it is None."""
    assert value is not None
    return value
