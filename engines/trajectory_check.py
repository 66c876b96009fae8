"""Check the result of a run against the contract of engines."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

# Tolerance on sample times relative to dt. The tolerance is above rounding and far below half a step.
TIME_TOLERANCE = 1e-6

Flaw = tuple[str, str]  # the value found, and the value expected


def flaw_of_shapes(run: Any, mechanism: Mechanism, samples: int) -> Flaw | None:
    """The first field whose shape or type is wrong for samples + 1 states, or None."""
    if not isinstance(run, Trajectory):
        return f"a {type(run).__name__}", "a Trajectory"
    count, motion = samples + 1, (samples + 1, len(mechanism.bodies), 3)
    shapes = {"t": (count,), "pose": motion, "twist": motion, "reaction": (count, mechanism.row_count)}
    for name, shape in shapes.items():
        if np.shape(getattr(run, name)) != shape:
            return f"{name} of the shape {np.shape(getattr(run, name))}", f"{shape}"
    for name, kind in (("warnings", tuple), ("reset_at", float), ("estimate", np.ndarray), ("unresolved_at", float)):
        value = getattr(run, name)
        if not isinstance(value, kind) and (value is not None or kind is tuple):
            return f"{name} of the type {type(value).__name__}", "the type in Trajectory"
    return None


def flaw_of_times(run: Trajectory, dt: float, samples: int, every: int) -> Flaw | None:
    """The largest difference [s] of the sample times from multiples of every * dt, or None for rounding."""
    error = float(np.max(np.abs(run.t - np.arange(samples + 1) * (every * dt))))
    rounding_of_sum = (samples * every) ** 2 * np.finfo(float).eps  # relative to dt, for a sum of steps
    if error <= max(TIME_TOLERANCE, rounding_of_sum) * dt:
        return None
    return f"an instant that is {error:.3g} s off with {every} steps a sample", f"multiples of {every * dt:g} s"


def flaw_of_reactions(run: Trajectory) -> Flaw | None:
    """The first row with unknown reactions at some, but not all, samples after the first, or None."""
    if not (np.isfinite(run.pose).all() and np.isfinite(run.twist).all()):
        return None  # a diverged run may have infinite forces
    known = np.isfinite(run.reaction[1:])
    rows = np.flatnonzero(known.any(axis=0) & ~known.all(axis=0))
    if not rows.size:
        return None
    t = run.t[1 + int(np.argmin(known[:, rows[0]]))]
    return f"no reaction of row {rows[0]} at {t:.4g} s", "a number at every sample after the first, or at none"


def flaw(run: Any, mechanism: Mechanism, dt: float, samples: int, every: int) -> str:
    """One sentence on how a result violates items 5 and 6 of the contract; empty if it satisfies them."""
    difference = flaw_of_shapes(run, mechanism, samples) or flaw_of_times(run, dt, samples, every)
    if difference is None and not (math.isfinite(run.stepping) and run.stepping >= 0):
        difference = f"stepping = {run.stepping!r} s", "CPU seconds from 0 on"
    difference = difference or flaw_of_reactions(run)
    return f"its run gave {difference[0]}; the contract of engines asks for {difference[1]}" if difference else ""
