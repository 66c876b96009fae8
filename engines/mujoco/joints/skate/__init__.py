"""How a skate gets into MuJoCo's model, which has no such joint: a choice of constructions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

from engines.mujoco.construction import Building
from engines.mujoco.joints.skate.contacts import add_blades, add_servos, add_wheels
from engines.mujoco.joints.skate.multipliers import add_forces, add_passive_forces
from engines.mujoco.joints.skate.rows import skate_rows
from engines.mujoco.joints.skate.tendons import add_friction_tendons, add_leapfrog, add_tendons
from engines.mujoco.written_rows import WrittenJoint
from reference.joints import Skate
from reference.mechanism import Mechanism

SkateBy = Literal[
    "rows", "tendon", "predicted tendon", "tendon friction", "leapfrog", "force", "passive", "servo", "blade", "wheel"
]
# These change once a step, so an integrator of several stages gains nothing and costs four times as much.
STEPWISE: tuple[SkateBy, ...] = ("tendon", "predicted tendon", "tendon friction", "leapfrog", "force")
assert set(STEPWISE) < set(get_args(SkateBy))


def slip_damping(mechanism: Mechanism) -> float:
    """How fast a written row lets slip die out [1/s].

    There is no gap to close, only slip that rounding leaves: it may take the motion's own time to die out, and a faster
    damping would cost accuracy. What turns sets that time; speed over a short arm would be far too fast.
    """
    return max(abs(body.twist[2]) for body in mechanism.bodies) or 1 / mechanism.time_scale


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
    damping = slip_damping(building.mechanism)
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
