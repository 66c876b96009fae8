"""What theory promises for a skate in each construction, and where one is known to fall short of it."""

from __future__ import annotations

from engines import EXACT, Promise
from reports.gate.checks import Deviation
from reports.gate.promises import Promises
from reports.pages.chain_orders import AMPLIFIED, OPEN, STEPPED

# Every row that is held only at the ends of steps makes a method of first order, whatever the integrator; a reflection
# is symmetric in time: second; extrapolation removes the powers it is given. MuJoCo's RK4 keeps its order 4 with rows
# that are written in every stage.
HELD = Promise(1, gap=2, slip=EXACT, differences=1)  # the row of the pose after the drift: no slip is left of it
BODIES = ("pinned_body", "pinned_body_free")
ORDERS: Promises = {
    "pymunk default": STEPPED,
    "pymunk tuned": HELD,
    "pymunk extended": Promise(6, slip=4, reaction=4, differences=8, amplified=AMPLIFIED),
    "mujoco default": Promise(1),
    "mujoco tuned": Promise(1, slip=2),
    "mujoco extended": Promise(4),
    "lagrange euler projection": OPEN["lagrange euler projection"],
    "lagrange rk4 projection": OPEN["lagrange rk4 projection"],
    "pymunk skate: centre's velocity zeroed": STEPPED,
    "pymunk skate: point's velocity zeroed": STEPPED,
    "pymunk skate: impulse at the blade": HELD,
    "pymunk skate: groove, stale heading": STEPPED,
    "pymunk skate: groove, predicted heading": HELD,
    "pymunk skate: reflection": Promise(2, energy=EXACT, differences=1),
    "pymunk skate: friction": STEPPED,
    "pymunk skate: groove, extrapolated": Promise(5, reaction=2, differences=8, amplified=66.0),
    "pymunk skate: reflection, extrapolated": Promise(8, slip=4, reaction=4, differences=8, amplified=AMPLIFIED),
    "mujoco friction blade": Promise(1),
    "mujoco thin wheel": Promise(1),
    "mujoco velocity servo": Promise(1),
    "mujoco tendon friction": Promise(1),
    "mujoco tendon": Promise(1),
    "mujoco tendon RK4": Promise(1),
    "mujoco leapfrog": Promise(2, slip=EXACT, energy=4, differences=1),
    "mujoco applied force": Promise(1),
    "mujoco passive force": Promise(4),
    "mujoco rows, shipped compliance": Promise(4),
    # A body on a pin is a chain of one link, and one that turns steadily about it leaves a tree nothing to integrate.
    **{(body, method): promise for body in BODIES for method, promise in OPEN.items()},
    **{("pinned_body_free", f"mujoco {variant}"): Promise(EXACT) for variant in ("default", "tuned", "extended")},
    ("pinned_body_free", "pymunk tuned"): Promise(2, rate=1, slip=1, reaction=1, differences=1),
}

ANOTHER_BODY = "by design: the velocity across is set without the turning that a force at the blade brings"
STRAIGHT = "by design: it never turns round, a naive zeroing makes a stable vehicle of an unstable one"
SOFT = "by design: a contact as shipped is a spring of 0.02 s and gives way, whatever the step"
LATE = "by design: a row at the old heading has no slip to stop in the first step, so its first force is none"
COMPLIANT = "by design: a row with its shipped compliance gives way, whatever the step"
ALTERNATES = "by design: what a reflection lacks in velocities changes sign with every step, and starts at its largest"
THIN = "by design: a wheel has a width on which it rolls, and an inertia of its own, whatever the step"

KNOWN: dict[tuple[str, str, str], Deviation] = {
    ("sleigh", "pymunk default", "outcome"): Deviation(ANOTHER_BODY),
    ("sleigh", "mujoco default", "order"): Deviation(SOFT, 2.5),
    ("sleigh", "pymunk skate: centre's velocity zeroed", "outcome"): Deviation(ANOTHER_BODY),
    ("sleigh", "pymunk skate: point's velocity zeroed", "outcome"): Deviation(ANOTHER_BODY),
    ("sleigh", "pymunk skate: reflection", "rate"): Deviation(ALTERNATES, 2.3),
    ("sleigh", "pymunk skate: reflection", "gap"): Deviation(ALTERNATES, 4.1),
    ("sleigh", "mujoco friction blade", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco thin wheel", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco thin wheel", "order"): Deviation(THIN, 2.5),
    ("sleigh", "mujoco velocity servo", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco tendon friction", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco tendon", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco tendon RK4", "reaction"): Deviation(LATE, 5.9),
    ("sleigh", "mujoco rows, shipped compliance", "order"): Deviation(COMPLIANT, 10),
    ("sleigh_backwards", "pymunk default", "error"): Deviation(STRAIGHT, 140),
    ("sleigh_backwards", "pymunk default", "rate"): Deviation(STRAIGHT, 98),
    ("sleigh_backwards", "pymunk default", "gap"): Deviation(STRAIGHT, 1.3),
    ("sleigh_backwards", "pymunk default", "energy"): Deviation(STRAIGHT, 25),
    ("sleigh_backwards", "pymunk default", "reaction"): Deviation(STRAIGHT, 43),
    ("sleigh_backwards", "pymunk default", "order"): Deviation(STRAIGHT, 2.5),
    ("sleigh_backwards", "mujoco default", "error"): Deviation(SOFT, 1.6),
    ("sleigh_backwards", "mujoco default", "rate"): Deviation(SOFT, 1.7),
    ("sleigh_backwards", "mujoco default", "energy"): Deviation(SOFT, 3300),
    ("sleigh_backwards", "mujoco default", "order"): Deviation(SOFT, 2.5),
}
