"""What theory promises for vehicles on ideal wheels in each method, and where one is known to fall short of it."""

from __future__ import annotations

# As for one skate, see `skate_known`; with pins between them pymunk's best is a groove, extrapolated from order 1.
ORDERS: dict[str, int] = {
    "pymunk default": 1,
    "pymunk tuned": 1,
    "pymunk extended": 5,
    "mujoco default": 1,
    "mujoco tuned": 1,
    "mujoco extended": 4,
    "lagrange euler projection": 1,
    "lagrange rk4 projection": 4,
}

KNOWN: dict[tuple[str, str, str], str] = {}
