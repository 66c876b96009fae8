"""Where a method is known to fall short of theory on ideal wheels, each with its reason."""

from __future__ import annotations

from reports.model.checks import Deviation
from reports.model.outcomes import Outcome

ANOTHER_VEHICLE = "by design: the velocity across is set without the turning that a force at the wheel brings"
SOFT = "by design: contacts as shipped are springs of 0.02 s and give way, whatever the step"
CARRIED = "ours: what a step rounds of an aimed groove is carried 66 times by the extrapolation"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("car_and_trailer", "pymunk default", "outcome"): Deviation(ANOTHER_VEHICLE, outcome=Outcome.SATURATED),
    ("car_and_trailer", "pymunk extended", "error"): Deviation(CARRIED, 2.8, rounding=True),
    ("car_and_trailer", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("cart", "pymunk default", "outcome"): Deviation(ANOTHER_VEHICLE, outcome=Outcome.SATURATED),
}
