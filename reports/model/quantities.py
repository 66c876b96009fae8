"""What is compared with the truth: each quantity's unit, below which error there is only rounding, and which two values
of one tell the same."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

DIGITS = 4  # of the numbers in a report's CSV files


@dataclass(frozen=True)
class Quantity:
    """A kind of error, with all facts that checks and tables need to know of it.

    rounding: errors below it carry no information on a model. Positions and angles lose about 1e-16 a step over 1e5
    steps, so 1e-11 has room for some ill-conditioning; velocities are differences of those over a step, and reactions
    of those again.
    """

    name: str  # the field of a Measurement
    unit: str
    rounding: float
    check: str  # the check of the gate of theory that holds it
    needs_truth: bool = True  # False for constraint violations, which follow from the joints and the run alone
    is_of_joints: bool = False  # tables of scenes have it beside the quantity of the page

    @property
    def label(self) -> str:
        return self.name

    @property
    def heading(self) -> str:
        """The header of a column with its errors, and the label of an axis."""
        return f"{self.label} error [{self.unit}]" if self.needs_truth else f"{self.label} [{self.unit}]"


# Tables and checks keep this order.
QUANTITIES = (
    Quantity("position", "m", 1e-11, "error"),
    Quantity("angle", "rad", 1e-11, "error"),
    Quantity("velocity", "m/s", 1e-10, "rate"),
    Quantity("rate", "rad/s", 1e-10, "rate"),
    Quantity("gap", "m", 1e-12, "gap", needs_truth=False, is_of_joints=True),
    Quantity("slip", "m/s", 1e-11, "gap", needs_truth=False, is_of_joints=True),
    Quantity("energy", "relative", 1e-11, "energy"),
    Quantity("reaction", "relative", 1e-9, "reaction", is_of_joints=True),
)


# Fields of a Measurement that are another measure of a quantity's error.
OF: Mapping[str, str] = {
    "position_rms": "position",
    **dict.fromkeys(("angle_rms", "angle_duration", "drive_gap", "estimate"), "angle"),
}


def quantity(name: str) -> Quantity:
    """Raises KeyError for a name that is not in QUANTITIES."""
    return {q.name: q for q in QUANTITIES}[name]


def printed(value: float) -> float:
    """One unit of the last of the DIGITS with which a value is printed; 0 for zero and for what is no number.

    A number and its text differ by half of it at most, and two numbers whose texts are neighbours by no more than one.
    """
    if value == 0 or not math.isfinite(value):
        return 0.0
    return 10.0 ** (math.floor(math.log10(abs(value))) + 1 - DIGITS)


def room(name: str, before: float, amplified: float = 1.0) -> tuple[float, float]:
    """What printing and rounding may change in a value: one unit of its last printed digit, and the quantity's floor.

    name: a field of a Measurement that is an error, a root mean square or an estimate of one; KeyError for another.
    Where another processor rounds each step otherwise, the motion moves by no more than `Quantity.rounding`, and by the
    triangle inequality its error too, however small it is. amplified: how many times the usual rounding the method
    carries (`engines.ConvergenceOrder`). The amplification by the motion itself is measured (`reports.gate.change`).
    """
    return printed(before), quantity(OF.get(name, name)).rounding * amplified


def agrees(name: str, now: float, before: float, amplified: float = 1.0) -> bool:
    """Whether two values of one quantity differ by no more than its `room`; two values that are no numbers agree.

    `now` may have all its digits, `before` the DIGITS of a file. Of 4,280 rows of two processors eight numbers go
    beyond this room, of pivots that are placed where curves touch, which feed rounding back; all others stay within two
    thirds of it.
    """
    allowed = sum(room(name, before, amplified))
    if not (math.isfinite(now) and math.isfinite(before)):
        return now == before or (math.isnan(now) and math.isnan(before))
    return abs(now - before) <= allowed
