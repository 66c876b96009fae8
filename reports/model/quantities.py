"""The quantities whose errors are measured, with their units, their rounding, and the facts that the gate needs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reports.model.outcomes import SATURATED, TORN

DIGITS = 4  # significant digits of the numbers in a report's CSV files


@dataclass(frozen=True)
class Quantity:
    """A kind of error.

    The rounding of positions and angles is 1e-11, since they lose about 1e-16 per step over 1e5 steps, and the problem
    may be ill-conditioned. Velocities are differences of positions over a step, and reactions of velocities, so their
    rounding is larger.
    """

    name: str  # the field of a Measurement
    unit: str
    rounding: float  # Errors below this value have no information about a model.
    check: str  # The name of its check in the gate of theory.
    needs_truth: bool = True  # False for constraint violations, which follow from the run alone.
    is_of_joints: bool = False  # Whether tables of scenes show it beside the quantity of the page.
    follows: str = ""  # The quantity whose error causes an error of this one.
    lag: float = 0.0  # Delay of a first-order value in a prescribed motion, in steps.
    # The largest comparable error, relative to the length of the mechanism or to the largest speed or rate of the
    # motion; for relative quantities and angles [rad] the error itself.
    largest: float = 1.0
    # Whether the time scale for an order below 2 is that of the angle if that is shorter. The judge's fourth-order run
    # does not show this time scale, since constraint drift dominates its positions and its energy is more accurate.
    scales_with_angle: bool = False

    @property
    def label(self) -> str:
        return self.name

    @property
    def heading(self) -> str:
        return f"{self.label} error [{self.unit}]" if self.needs_truth else f"{self.label} [{self.unit}]"


# Tables and checks keep this order.
QUANTITIES = (
    Quantity("position", "m", 1e-11, "error", largest=SATURATED, scales_with_angle=True),
    Quantity("angle", "rad", 1e-11, "error", largest=SATURATED),
    Quantity("velocity", "m/s", 1e-10, "rate", follows="position", lag=0.5),
    Quantity("rate", "rad/s", 1e-10, "rate", follows="angle", lag=0.5),
    Quantity("gap", "m", 1e-12, "gap", needs_truth=False, is_of_joints=True, largest=TORN),
    Quantity("slip", "m/s", 1e-11, "gap", needs_truth=False, is_of_joints=True, follows="velocity", lag=1.0),
    Quantity("energy", "relative", 1e-11, "energy", lag=0.5, scales_with_angle=True),
    Quantity("reaction", "relative", 1e-9, "reaction", is_of_joints=True, lag=1.0),
)
QUANTITY: Mapping[str, Quantity] = {entry.name: entry for entry in QUANTITIES}


# Field of a Measurement -> the quantity that it measures in another way.
OF: Mapping[str, str] = {
    "position_rms": "position",
    **dict.fromkeys(("angle_rms", "angle_duration", "drive_gap", "estimate"), "angle"),
}


def quantity(name: str) -> Quantity:
    """The quantity with this name. Raises KeyError for an unknown name."""
    return QUANTITY[name]


def printed(value: float) -> float:
    """One unit of the last printed digit (of DIGITS) of a value; 0 for zero, infinity and NaN."""
    if value == 0 or not math.isfinite(value):
        return 0.0
    return 10.0 ** (math.floor(math.log10(abs(value))) + 1 - DIGITS)


def rounding_tolerance(name: str, before: float, amplified: float = 1.0) -> tuple[float, float]:
    """The allowed difference of a value between processors: (one unit of its last printed digit, rounding).

    name: a field of a Measurement that is an error, its root mean square or its estimate. amplified: the factor by
    which the method amplifies rounding (`engines.ConvergenceOrder`). The amplification by the motion is measured in
    `reports.gate.change`. Raises KeyError for another field.
    """
    return printed(before), quantity(OF.get(name, name)).rounding * amplified


def agrees(name: str, now: float, before: float, amplified: float = 1.0) -> bool:
    """Whether two values of one quantity differ by no more than its `rounding_tolerance`; NaN agrees with NaN.

    `before` may be rounded to DIGITS. In 4,280 rows of two processors eight numbers differ by more, all for pivots at
    the contact of two curves, which amplify rounding. All others differ by less than two thirds of the tolerance.
    """
    allowed = sum(rounding_tolerance(name, before, amplified))
    if not (math.isfinite(now) and math.isfinite(before)):
        return now == before or (math.isnan(now) and math.isnan(before))
    return abs(now - before) <= allowed
