"""What theory promises for vehicles on ideal wheels in each method, and where one is known to fall short of it."""

from __future__ import annotations

from engines import EXACT, Promise
from reports.gate.checks import Deviation
from reports.gate.promises import Promises
from reports.pages.chain_orders import CLOSING, OPEN, STEPPED

# As for one skate, see `skate_known`; with pins between them pymunk's best is a groove, extrapolated from order 1.
# The weights of an extrapolation from the first power on add up to 66 in size.
ORDERS: Promises = {
    "pymunk default": STEPPED,
    "pymunk tuned": CLOSING,
    "pymunk extended": Promise(5, slip=4, reaction=2, differences=8, amplified=66.0),
    "mujoco default": Promise(1, gap=EXACT),
    "mujoco tuned": Promise(1, gap=EXACT, slip=2),
    "mujoco extended": Promise(4, gap=EXACT),
    "lagrange euler projection": OPEN["lagrange euler projection"],
    "lagrange rk4 projection": OPEN["lagrange rk4 projection"],
}

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
