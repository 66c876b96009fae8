"""Engines under test, and what the suite asks of one: `engines.contract`, in numbered sentences."""

from engines.contract import (
    CLAIM,
    EXACT,
    Engine,
    Holder,
    Promise,
    Run,
    Size,
    Softness,
    Unpromised,
    Unsupported,
    refuse_forces,
)

__all__ = [
    "CLAIM",
    "EXACT",
    "Engine",
    "Holder",
    "Promise",
    "Run",
    "Size",
    "Softness",
    "Unpromised",
    "Unsupported",
    "refuse_forces",
]
