"""The orders that theory promises of the variants that every chain is run in."""

from __future__ import annotations

# A tree of joints has no constraint, so what MuJoCo's settings leave is the integrator's order.
OPEN: dict[str, int] = {
    "pymunk default": 1,
    "pymunk tuned": 1,
    "pymunk extended": 6,
    "mujoco default": 1,
    "mujoco tuned": 4,
    "mujoco extended": 4,
    "lagrange euler projection": 1,
    "lagrange rk4 projection": 4,
}
# Where a loop is closed by a spring tied to the step, its softness sets the order, not RK4.
CLOSED: dict[str, int] = {**OPEN, "mujoco tuned": 2}
