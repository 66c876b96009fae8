"""What is compared with the truth: each quantity's unit, below which error there is only rounding, and which two values
of one tell the same."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

DIGITS = 4  # of the numbers in a report's CSV files


@dataclass(frozen=True)
class Quantity:
    """`name` is the field of a Measurement; errors below `rounding` (in `unit`) carry no information on a model.

    `check`: the check of the gate of theory that holds it. Rounding: positions and angles lose about 1e-16 a step over
    1e5 steps, so 1e-11 has room for some ill-conditioning; velocities are differences of those over a step, and
    reactions of those again.
    """

    name: str
    unit: str
    rounding: float
    check: str

    @property
    def label(self) -> str:
        return self.name

    @property
    def axis(self) -> str:
        """The label of an axis with its errors."""
        return f"{self.label} error [{self.unit}]"


# The order in which tables and checks have them.
QUANTITIES = (
    Quantity("position", "m", 1e-11, "error"),
    Quantity("angle", "rad", 1e-11, "error"),
    Quantity("velocity", "m/s", 1e-10, "rate"),
    Quantity("rate", "rad/s", 1e-10, "rate"),
    Quantity("gap", "m", 1e-12, "gap"),
    Quantity("slip", "m/s", 1e-11, "gap"),
    Quantity("energy", "relative", 1e-11, "energy"),
    Quantity("reaction", "relative", 1e-9, "reaction"),
)


# Fields of a Measurement that are another measure of a quantity's error.
OF: Mapping[str, str] = {
    "position_rms": "position",
    "angle_rms": "angle",
    "angle_duration": "angle",
    "drive_gap": "angle",
    "estimate": "angle",
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

    `name`: a field of a Measurement that is an error, a root mean square or an estimate of one. An error is a
    difference from the truth. Where another processor rounds each step otherwise, the motion moves by no more than
    `Quantity.rounding`, which is what 1e5 steps may lose. By the triangle inequality the error moves by no more than
    that, however small it is: this floor is never zero. `amplified`: how many times the usual rounding the method
    carries, as the weights of a combination of runs do (`engines.Promise.amplified`). What a motion itself amplifies is
    not in it, and has to be measured (`reports.gate.change`). Raises KeyError for another name.
    """
    return printed(before), quantity(OF.get(name, name)).rounding * amplified


def agrees(name: str, now: float, before: float, amplified: float = 1.0) -> bool:
    """Whether two values of one quantity differ by no more than its `room`: nothing is run for it.

    `now` may have all its digits, `before` the DIGITS of a file. Of 4,280 rows that two processors gave 1,511 errors
    differ in print. Of those that can be compared eight numbers of four rows go beyond this room: of pivots that are
    placed where curves touch, at 300 steps a sample and more, which feed rounding back. All others stay
    within two thirds of it. Two values that are no numbers agree, and one that is a number never agrees with one that
    is not. Raises KeyError for another name.
    """
    allowed = sum(room(name, before, amplified))
    if not (math.isfinite(now) and math.isfinite(before)):
        return now == before or (math.isnan(now) and math.isnan(before))
    return abs(now - before) <= allowed
