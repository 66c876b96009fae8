"""What is compared with the truth: each quantity's unit, and below which error there is only rounding."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Quantity:
    """`name` is the field of a Measurement; errors below `rounding` (in `unit`) carry no information on a model.

    Rounding: positions and angles lose about 1e-16 a step over 1e5 steps, so 1e-11 has room for some ill-conditioning;
    velocities are differences of those over a step, and reactions of those again.
    """

    name: str
    label: str
    unit: str
    rounding: float


QUANTITIES = (
    Quantity("position", "position", "m", 1e-11),
    Quantity("angle", "angle", "rad", 1e-11),
    Quantity("velocity", "velocity", "m/s", 1e-10),
    Quantity("rate", "rate", "rad/s", 1e-10),
    Quantity("gap", "gap", "m", 1e-12),
    Quantity("slip", "slip", "m/s", 1e-11),
    Quantity("energy", "energy", "relative", 1e-11),
    Quantity("reaction", "reaction", "relative", 1e-9),
)


def quantity(name: str) -> Quantity:
    """Raises KeyError for a name that is not in QUANTITIES."""
    return {q.name: q for q in QUANTITIES}[name]
