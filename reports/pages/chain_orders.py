"""What theory promises of the variants that every chain of pins is run in, and of pymunk's where a scene changes it."""

from __future__ import annotations

from collections.abc import Iterable

from engines import EXACT, Promise
from reports.gate.promises import Promises

# Impulses at the ends of steps, read as they stand: everything of first order.
STEPPED = Promise(1, differences=1)
# All of a gap is closed in every step, so that only what one drift opens is left: second order.
CLOSING = Promise(1, gap=2, differences=1)
# From rest the missing half kick is a delay, which the kick in the last step makes up for in the velocities.
FROM_REST = Promise(1, rate=2, gap=2, slip=1, differences=1)
# A prescribed motion has no kick to miss: what is left of a pose is its gap.
PRESCRIBED = Promise(2, rate=1, slip=1, energy=1, reaction=1, differences=1)
# Extrapolation removes powers 2 to 5. A reaction is a change of velocity over the finest of its eight steps; and the
# weights of the runs, whose sizes add up to AMPLIFIED, carry the rounding of each.
AMPLIFIED = 17.0
EXTRAPOLATED = Promise(6, reaction=4, differences=8, amplified=AMPLIFIED)
# A loop closed by a spring of five steps: RK4's own error is small beside that of the spring.
SPRUNG = Promise(2, rate=1, slip=1, energy=1, reaction=1, integrator=4)

# A tree of joints has no constraint, so what MuJoCo's settings leave is the integrator's order, and joints can't part.
OPEN: dict[str, Promise] = {
    "pymunk default": STEPPED,
    "pymunk tuned": CLOSING,
    "pymunk extended": EXTRAPOLATED,
    "mujoco default": Promise(1, gap=EXACT, slip=EXACT),
    "mujoco tuned": Promise(4, gap=EXACT, slip=EXACT),
    "mujoco extended": Promise(4, gap=EXACT, slip=EXACT),
    "lagrange euler projection": Promise(1, gap=EXACT, slip=EXACT),
    "lagrange rk4 projection": Promise(4, gap=EXACT, slip=EXACT),
}
# Where a loop is closed by a spring tied to the step, its softness sets the order, not RK4.
CLOSED: dict[str, Promise] = {
    **OPEN,
    "mujoco default": Promise(1),
    "mujoco tuned": SPRUNG,
    "mujoco extended": Promise(4),
}


def from_rest(scenes: Iterable[str]) -> Promises:
    """What changes in scenes that start from rest."""
    return {(scene, "pymunk tuned"): FROM_REST for scene in scenes}


def prescribed(scene: str, integrators: Iterable[str] = ("euler", "rk4")) -> Promises:
    """What changes in a scene without a freedom of its own: projection leaves nothing of the integrator's error."""
    return {
        (scene, "pymunk tuned"): PRESCRIBED,
        **{(scene, f"lagrange {integrator} projection"): Promise(EXACT) for integrator in integrators},
    }
