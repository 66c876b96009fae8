"""How a skate gets into MuJoCo's model, which has no such joint: a choice of constructions, and the rows themselves."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal, get_args

from engines.mujoco.construction import Building
from engines.mujoco.skate_contacts import add_blades, add_servos, add_wheels
from engines.mujoco.skate_multipliers import add_forces, add_passive_forces
from engines.mujoco.skate_tendons import add_friction_tendons, add_leapfrog, add_tendons
from engines.mujoco.written_rows import Row, State, WrittenJoint
from reference.joints import Skate

SkateBy = Literal[
    "rows", "tendon", "predicted tendon", "tendon friction", "leapfrog", "force", "passive", "servo", "blade", "wheel"
]
# These change once a step, so an integrator of several stages gains nothing and costs four times as much.
STEPWISE: tuple[SkateBy, ...] = ("tendon", "predicted tendon", "tendon friction", "leapfrog", "force")
assert set(STEPWISE) < set(get_args(SkateBy))


def add_skates(building: Building, skates: Sequence[Skate], by: SkateBy) -> None:
    """Add the skates to the model by this construction. Raises Unsupported in a sentence where it can't hold them.

    "rows": written in every stage. "tendon": a fixed tendon whose coefficients are rewritten before every step, as an
    equality row; "predicted tendon": at the pose that the velocity leads to; "tendon friction": as friction loss;
    "leapfrog": reflecting a velocity half a step behind. "force": the exact multiplier's force held over the step;
    "passive": in every stage. "servo": a velocity servo across the blade at a site; "blade": a capsule that touches a
    plane with friction across it; "wheel": a thin wheel that rolls on it.
    """
    if not skates:
        return
    if by in ("servo", "blade", "wheel"):
        {"servo": add_servos, "blade": add_blades, "wheel": add_wheels}[by](building, skates)
        return
    # There is no gap to close, only slip that rounding leaves: it may take the motion's own time to die out, and a
    # faster damping would cost accuracy. What turns sets that time; speed over a short arm would be far too fast.
    turning = max(abs(body.twist[2]) for body in building.mechanism.bodies)
    damping = turning or 1 / building.mechanism.time_scale
    joints = [
        WrittenJoint(building.index(skate.first), building.index(skate.second), 1, skate_rows(skate, damping))
        for skate in skates
    ]
    match by:
        case "rows":
            building.written += joints
        case "tendon":
            add_tendons(building, joints)
        case "predicted tendon":
            add_tendons(building, joints, ahead=building.dt)
        case "tendon friction":
            add_friction_tendons(building, joints)
        case "leapfrog":
            add_leapfrog(building, joints)
        case "force":
            add_forces(building, joints)
        case "passive":
            add_passive_forces(building, joints)


def skate_rows(skate: Skate, damping: float) -> Callable[[float, State, State], Sequence[Row]]:
    """The skate's row and -(dJ/dt) v - damping slip, see `reference.joints.Skate`."""
    (point_x, point_y), blade = skate.second_point, skate.angle
    sine_of, cosine_of = math.sin, math.cos

    def rows(_t: float, first: State, second: State) -> Sequence[Row]:
        x1, y1, _, vx1, vy1, omega1 = first
        x2, y2, angle, vx2, vy2, omega2 = second
        cosine, sine = cosine_of(angle), sine_of(angle)
        own_x, own_y = cosine * point_x - sine * point_y, sine * point_x + cosine * point_y
        ahead_x, ahead_y = cosine_of(angle + blade), sine_of(angle + blade)
        vx2, vy2 = vx2 - omega2 * own_y, vy2 + omega2 * own_x  # of the blade's point
        arm_x, arm_y = x2 + own_x - x1, y2 + own_y - y1
        rate_x, rate_y = vx2 - vx1 + omega1 * arm_y, vy2 - vy1 - omega1 * arm_x
        slip = ahead_x * rate_y - ahead_y * rate_x
        square = omega2 * omega2
        gain_x = omega1 * (vy2 - vy1) - square * own_x
        gain_y = -omega1 * (vx2 - vx1) - square * own_y
        changing = ahead_x * gain_y - ahead_y * gain_x - omega2 * (ahead_x * rate_x + ahead_y * rate_y)
        return (
            (
                ahead_y, -ahead_x, -arm_y * ahead_y - arm_x * ahead_x,
                -ahead_y, ahead_x, own_x * ahead_x + own_y * ahead_y,
                -changing - damping * slip,
            ),
        )  # fmt: skip

    return rows
