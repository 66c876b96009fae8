"""Engines under test, and what the suite asks of one: `engines.contract`, in numbered sentences."""

from engines.contract import (
    CLAIM,
    EXACT,
    ConvergenceOrder,
    Enforcement,
    Engine,
    EngineWrapper,
    Instant,
    NotDeclared,
    OneShot,
    Regularisation,
    Run,
    Size,
    Unsupported,
    method_name,
    refuse_forces,
)

__all__ = [
    "CLAIM",
    "EXACT",
    "ConvergenceOrder",
    "Enforcement",
    "Engine",
    "EngineWrapper",
    "Instant",
    "NotDeclared",
    "OneShot",
    "Regularisation",
    "Run",
    "Size",
    "Unsupported",
    "method_name",
    "refuse_forces",
]
