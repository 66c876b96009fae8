"""Where a method is known to fall short of theory on ideal wheels, each with its reason."""

from __future__ import annotations

from reports.gate.checks import Deviation

ANOTHER_VEHICLE = "by design: the velocity across is set without the turning that a force at the wheel brings"
SOFT = "by design: contacts as shipped are springs of 0.02 s and give way, whatever the step"
ROUNDING = "ours: the hardened rows of the light casters reach their rounding at 1e-10 rad, ten times the usual"
SWEPT = "ours: hinges and skates pass impulses round, and forty sweeps leave some of them"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("car_and_trailer", "pymunk default", "outcome"): Deviation(ANOTHER_VEHICLE),
    ("car_and_trailer", "pymunk extended", "error"): Deviation(SWEPT, 2.3),
    ("car_and_trailer", "pymunk extended", "reaction"): Deviation(SWEPT, 2.9),
    ("car_and_trailer", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("cart", "pymunk default", "outcome"): Deviation(ANOTHER_VEHICLE),
    ("cart", "mujoco extended", "error"): Deviation(ROUNDING, 5.6),
    ("cart", "mujoco extended", "rate"): Deviation(ROUNDING, 5.6),
    ("cart", "mujoco extended", "order"): Deviation(ROUNDING, 2.4),
}
