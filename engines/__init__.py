"""Engines under test, and what the suite asks of one: `engines.contract`, in numbered sentences."""

from engines.contract import (
    CLAIM,
    EXACT,
    Around,
    Engine,
    Holder,
    Instant,
    OneShot,
    Promise,
    Run,
    Size,
    Softness,
    Unpromised,
    Unsupported,
    method_name,
    refuse_forces,
)

__all__ = [
    "CLAIM",
    "EXACT",
    "Around",
    "Engine",
    "Holder",
    "Instant",
    "OneShot",
    "Promise",
    "Run",
    "Size",
    "Softness",
    "Unpromised",
    "Unsupported",
    "method_name",
    "refuse_forces",
]
