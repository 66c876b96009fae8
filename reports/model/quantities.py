"""The quantities whose errors are measured, with units, rounding errors and properties for the gate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reports.model.outcomes import SATURATED, TORN

DIGITS = 4  # Number of significant digits in a report's CSV files.


@dataclass(frozen=True)
class Quantity:
    """A kind of error. The rounding error of positions and angles is 1e-11. A step has a rounding error of about 1e-16,
    there are up to 1e5 steps, and the problem may be ill-conditioned. Velocities and reactions have larger rounding
    errors, since they are differences of positions and of velocities."""

    name: str  # A field of Measurement.
    unit: str
    rounding: float  # An error below this value is only rounding.
    check: str  # Name of the check in the gate of theory.
    needs_truth: bool = True  # Whether the error needs the exact motion, unlike constraint violations.
    is_of_joints: bool = False  # Whether tables of scenes show this quantity in addition to the quantity of the page.
    follows: str = ""  # A quantity whose error causes an error of this quantity.
    lag: float = 0.0  # Delay of a first-order value in a prescribed motion, in steps.
    # The largest comparable error, relative to the mechanism's length, or to the largest speed or rate. Errors of
    # angles [rad] and of relative quantities are absolute.
    largest: float = 1.0
    # Whether orders below 2 use the time scale of the angle if this is shorter. The judge's fourth-order run does not
    # show this time scale, since constraint drift dominates the positions and the energy is more accurate.
    scales_with_angle: bool = False

    @property
    def label(self) -> str:
        return self.name

    @property
    def heading(self) -> str:
        return f"{self.label} error [{self.unit}]" if self.needs_truth else f"{self.label} [{self.unit}]"


# The order of quantities in tables and checks.
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


# Further field of Measurement -> the quantity of its error.
OF: Mapping[str, str] = {
    "position_rms": "position",
    **dict.fromkeys(("angle_rms", "angle_duration", "drive_gap", "estimate"), "angle"),
}


def quantity(name: str) -> Quantity:
    """The quantity with this name. Raises KeyError for an unknown name."""
    return QUANTITY[name]


def printed(value: float) -> float:
    """One unit of the last printed digit of a value with DIGITS digits, or zero for 0, infinity and NaN."""
    if value == 0 or not math.isfinite(value):
        return 0.0
    return 10.0 ** (math.floor(math.log10(abs(value))) + 1 - DIGITS)


def rounding_tolerance(name: str, before: float, amplified: float = 1.0) -> tuple[float, float]:
    """Two terms of the allowed difference between processors: (one unit of the last printed digit, rounding). name: a
    field of Measurement that is an error, a root mean square or an estimate. amplified: factor by which the method
    amplifies rounding (`engines.ConvergenceOrder`). `reports.gate.change` measures the amplification by the motion.
    Raises KeyError for any other field."""
    return printed(before), quantity(OF.get(name, name)).rounding * amplified


def agrees(name: str, now: float, before: float, amplified: float = 1.0) -> bool:
    """Whether two values of a quantity differ by at most `rounding_tolerance`. NaN agrees with NaN. `before` may be
    rounded to DIGITS. In 4,280 rows of two processors only eight numbers differ by more. These are errors of pivots at
    the contact of two curves, which amplify rounding."""
    allowed = sum(rounding_tolerance(name, before, amplified))
    if not (math.isfinite(now) and math.isfinite(before)):
        return now == before or (math.isnan(now) and math.isnan(before))
    return abs(now - before) <= allowed
