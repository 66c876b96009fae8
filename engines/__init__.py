"""Engines under test. `engines.contract` lists the contract of an engine in numbered items."""

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

__all__ = ["CLAIM", "EXACT", "ConvergenceOrder", "Enforcement", "Engine", "EngineWrapper", "Instant", "NotDeclared"]
__all__ += ["OneShot", "Regularisation", "Run", "Size", "Unsupported", "method_name", "refuse_forces"]
