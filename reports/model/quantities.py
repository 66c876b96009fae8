"""The quantities that are compared with the true motion: unit, rounding, and the facts that the gate needs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from reports.model.outcomes import SATURATED, TORN

DIGITS = 4  # of the numbers in a report's CSV files


@dataclass(frozen=True)
class Quantity:
    """A kind of error, with all its facts for checks and tables.

    rounding: smaller errors carry no information on a model. Positions and angles lose about 1e-16 a step over 1e5
    steps, so 1e-11 allows some ill-conditioning; velocities are differences of positions over a step, and reactions are
    differences of velocities.
    """

    name: str  # the field of a Measurement
    unit: str
    rounding: float
    check: str  # the name of its check in the gate of theory
    needs_truth: bool = True  # False for constraint violations, which follow from the joints and the run alone
    is_of_joints: bool = False  # tables of scenes have it beside the quantity of the page
    follows: str = ""  # the quantity whose error causes one of this
    lag: float = 0.0  # steps by which a first-order value is late in a prescribed motion; 0 for poses, which are not
    # The largest comparable error: in multiples of the mechanism's length, of the largest speed or rate of the motion,
    # or, for relative quantities and angles [rad], itself.
    largest: float = 1.0
    # Whether the time scale of an order below 2 is the angle's if that is shorter: the fourth-order run of the judge
    # does not show it, as its positions hold the drift of the constraints, and its energy is an order better.
    scales_with_angle: bool = False

    @property
    def label(self) -> str:
        return self.name

    @property
    def heading(self) -> str:
        """The header of a column with its errors, and the label of an axis."""
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
QUANTITY: Mapping[str, Quantity] = {each.name: each for each in QUANTITIES}


# Field of a Measurement -> the quantity that it measures in another way.
OF: Mapping[str, str] = {
    "position_rms": "position",
    **dict.fromkeys(("angle_rms", "angle_duration", "drive_gap", "estimate"), "angle"),
}


def quantity(name: str) -> Quantity:
    """Raises KeyError for a name that is not in QUANTITIES."""
    return QUANTITY[name]


def printed(value: float) -> float:
    """One unit of the last printed digit (of DIGITS) of a value; 0 for zero, infinity and NaN."""
    if value == 0 or not math.isfinite(value):
        return 0.0
    return 10.0 ** (math.floor(math.log10(abs(value))) + 1 - DIGITS)


def rounding_tolerance(name: str, before: float, amplified: float = 1.0) -> tuple[float, float]:
    """How much a value may differ between processors: (one unit of its last printed digit, rounding).

    name: a field of a Measurement that is an error, its root mean square or its estimate; KeyError for another. Other
    rounding moves the motion by at most `Quantity.rounding`, and so changes its error by no more. amplified: the factor
    by which the method amplifies rounding (`engines.ConvergenceOrder`). The amplification by the motion is measured in
    `reports.gate.change`.
    """
    return printed(before), quantity(OF.get(name, name)).rounding * amplified


def agrees(name: str, now: float, before: float, amplified: float = 1.0) -> bool:
    """Whether two values of one quantity differ by no more than its `rounding_tolerance`; NaN agrees with NaN.

    `before` may be rounded to DIGITS. In 4,280 rows of two processors eight numbers differ by more: those of pivots at
    the contact of two curves, where rounding feeds back. All others differ by less than two thirds of the tolerance.
    """
    allowed = sum(rounding_tolerance(name, before, amplified))
    if not (math.isfinite(now) and math.isfinite(before)):
        return now == before or (math.isnan(now) and math.isnan(before))
    return abs(now - before) <= allowed
