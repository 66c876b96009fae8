"""What theory promises for vehicles on ideal wheels in each method, and where one is known to fall short of it."""

from __future__ import annotations

from reports.pages.chain_orders import CLOSING, OPEN, STEPPED
from reports.promises import EXACT, Promise, Promises

# As for one skate, see `skate_known`; with pins between them pymunk's best is a groove, extrapolated from order 1.
ORDERS: Promises = {
    "pymunk default": STEPPED,
    "pymunk tuned": CLOSING,
    "pymunk extended": Promise(5, slip=4, reaction=2, differences=8),
    "mujoco default": Promise(1, gap=EXACT),
    "mujoco tuned": Promise(1, gap=EXACT, slip=2),
    "mujoco extended": Promise(4, gap=EXACT),
    "lagrange euler projection": OPEN["lagrange euler projection"],
    "lagrange rk4 projection": OPEN["lagrange rk4 projection"],
}

ANOTHER_VEHICLE = "by design: the velocity across is set without the turning that a force at the wheel brings"
SOFT = "by design: contacts as shipped are springs of 0.02 s and give way, whatever the step"
ROUNDING = "ours: the hardened rows of the light casters reach their rounding at 1e-10 rad, ten times the usual"

KNOWN: dict[tuple[str, str, str], str] = {
    **{
        (scene, "pymunk default", check): ANOTHER_VEHICLE
        for scene in ("car_and_trailer", "cart")
        for check in ("outcome", "error")
    },
    ("car_and_trailer", "pymunk default", "reaction"): ANOTHER_VEHICLE,
    **{("car_and_trailer", "mujoco default", check): SOFT for check in ("order", "reaction")},
    ("cart", "mujoco default", "order"): SOFT,
    ("cart", "mujoco extended", "order"): ROUNDING,
}
