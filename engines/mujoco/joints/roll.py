"""A Roll in MuJoCo: by contact and friction (`RollContact`), or by two rows of ours, exact in every stage ("rows").

A contact's rows obey J a = -b J v - k gap, without the -(dJ/dt) v of a curved or moving contact (in 4.0.1): rolling
then lags by about a time constant times the missing acceleration, and converges with the first power of the step at
best.
"""

from __future__ import annotations

import math
from cmath import rect
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.mujoco.construction import Building
from engines.mujoco.stiffness import STIFFEST, Shipped
from engines.rolling_table import rolled, unplaced
from reference.checks import InvalidMechanism, Positive, Valid
from reference.mechanism import Mechanism
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Ring
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
Cone = Literal["pyramidal", "elliptic"]
# A pair that just touches must collide whatever its distance is rounded to: this part of the mechanism's length.
TOUCH = 1e-12
# Of the largest reaction: a contact that is absent leaves nothing but rounding.
NOTHING = 1e-9
# The turn of the curves [rad] under the contact in one step, beyond which no method of order 4 is worth its name.
FAST = 0.1


@dataclass(frozen=True)
class RollContact(Valid):
    """Collision and friction: public settings only, the shipped ones unless said otherwise.

    `friction`: the coefficient. `steps`: the contact's time constant in steps (clamped as `engines.mujoco.stiffness`
    says) with its impedance at the limit; None for the shipped 0.02 s. `stick`: slip dies as fast as the integrator
    allows, at the rate 1/dt, and 2/dt for Runge-Kutta's; MuJoCo reads `solreffriction` with the elliptic cone only (a
    test in `tests/engines/test_mujoco_upstream.py` asks it).
    """

    friction: Positive = 1.0
    steps: Positive | None = None
    stick: bool = False
    cone: Cone = "pyramidal"

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stick and self.cone != "elliptic":
            raise InvalidMechanism(
                f"rolling by contact: stick is {self.stick!r}, but MuJoCo has that in the elliptic cone only"
            )


RollBy = RollContact | Literal["rows"]


def add_rolls(building: Building, rolls: Sequence[Roll], by: RollBy) -> None:
    """Add the rolls by this construction. Raises Unsupported for curves that MuJoCo has no shape for."""
    if not rolls:
        return
    if isinstance(by, RollContact):
        _add_contacts(building, rolls, by)
        return
    for roll in rolls:
        building.write("roll", roll, building.gains, rolled(roll.rolling))


def _add_contacts(building: Building, rolls: Sequence[Roll], by: RollContact) -> None:
    """Shapes, and the pairs of them that collide."""
    spec, shipped = building.spec, Shipped()
    reference, impedance = shipped.reference(building.mechanism, building.dt), shipped.impedance
    if by.steps is not None:
        reference, impedance = (by.steps * building.dt, 1.0), STIFFEST
    for roll in rolls:
        pair = spec.add_pair(
            geomname1=_add_shape(building, roll, roll.first, roll.rolling.ground),
            geomname2=_add_shape(building, roll, roll.second, roll.rolling.body),
            condim=3,
            friction=[by.friction, by.friction, 0.005, 0.0001, 0.0001],  # the last three are none of three rows
            solref=list(reference),
            solimp=list(impedance),
            margin=TOUCH * building.mechanism.length_scale,
        )
        if by.stick:
            runge_kutta = spec.option.integrator == mujoco.mjtIntegrator.mjINT_RK4
            pair.solreffriction = [-1e-9, -(2.0 if runge_kutta else 1.0) / building.dt]
        building.size += roll.size
    building.contact = True
    spec.option.cone = getattr(mujoco.mjtCone, f"mjCONE_{by.cone.upper()}")


def _add_shape(building: Building, roll: Roll, owner: str | None, curve: Curve) -> str:
    """A plane, a sphere or an ellipsoid for a body's curve; the name of the geom.

    Each body's frame is parallel to the world's at t = 0 (see `engines.tree`), so a shape is turned by the body's start
    angle. In the plane a sphere is a circle, and it touches in one point where a cylinder touches in two.
    """
    curve, shift, angle = unplaced(curve)
    index, body = building.index(owner), building.carrier(owner)
    start = 0.0 if index is None else building.mechanism.bodies[index].pose[2]
    name = f"{roll.name}: {'ground' if owner is None else owner}"

    def add(kind: Any, inside: complex, quaternion: list[float], size: list[float]) -> str:
        place = rect(1.0, start) * (shift + rect(1.0, angle) * inside)
        # Nothing collides by itself, only the pair that is named.
        apart: dict[str, Any] = {"mass": 0.0, "contype": 0, "conaffinity": 0}
        body.add_geom(name=name, type=kind, pos=[place.real, place.imag, 0.0], quat=quaternion, size=size, **apart)
        return name

    half = (start + angle) / 2
    turned = [math.cos(half), 0.0, 0.0, math.sin(half)]
    match curve:
        case Line() if owner is None:
            # A plane's face is along its z axis: a quarter turn lays that out of the material, which is on the left.
            out, quarter = -1j * rect(1.0, curve.heading + angle), math.sqrt(0.5)
            upright = [quarter, -quarter * out.imag, quarter * out.real, 0.0]
            return add(mujoco.mjtGeom.mjGEOM_PLANE, complex(*curve.through), upright, [1.0, 1.0, 1.0])
        case Line():
            raise Unsupported(
                f"roll {roll.name!r}: {owner!r} has a straight side; MuJoCo's planes are fixed to the ground, and our "
                "adapter builds no box"
            )
        case Circle():
            return add(mujoco.mjtGeom.mjGEOM_SPHERE, complex(*curve.centre), turned, [curve.radius, 0.0, 0.0])
        case Ellipse():
            depth = min(curve.along_x, curve.along_y)
            return add(mujoco.mjtGeom.mjGEOM_ELLIPSOID, 0j, turned, [curve.along_x, curve.along_y, depth])
        case Ring():
            raise Unsupported(
                f"roll {roll.name!r}: our adapter builds no hollow side; a height field or a plugin of MuJoCo has one"
            )
        case _:
            raise Unsupported(
                f"roll {roll.name!r}: our adapter builds no shape like a {type(curve).__name__.lower()} in MuJoCo, but "
                "planes, circles and ellipses"
            )


def roll_warnings(mechanism: Mechanism, step: float, t: Array, pose: Array, twist: Array, reaction: Array) -> list[str]:
    """What MuJoCo does not say of a run (times,) with this step [s]: a contact was lost, or was too fast to follow.

    Nearly conformal curves: the contact runs along them by omega / (curvature_A + curvature_B), so that it turns by
    omega dt / conformality in a step, which must stay small whatever the body itself turns by.
    """
    warnings, begin = list[str](), 0

    def relative(states: Array, joint: Roll) -> Array:
        names, out = (joint.first, joint.second), np.zeros((2, len(t)))
        for turning, name in zip(out, names, strict=True):
            turning[:] = 0.0 if name is None else states[:, mechanism.body_index(name), 2]
        return out[1] - out[0]

    for joint in mechanism.joints if len(t) else ():
        force = np.abs(reaction[:, begin : begin + joint.size])
        begin += joint.size
        if not isinstance(joint, Roll):
            continue
        size = force.max(axis=1)
        absent = size <= NOTHING * size.max()
        if absent.any() or not size.max() > 0:
            share, when = np.count_nonzero(absent) / len(t), t[int(np.argmax(absent))]
            words = f"it carries nothing in {share:.2g} of the samples, first at {when:.4g} s"
            warnings.append(f"ours: the contact {joint.name!r} was lost: {words}")
        turned = np.abs(relative(twist, joint)) * step / joint.rolling.contact(relative(pose, joint)).conformality
        worst = int(np.argmax(turned))
        if turned[worst] > FAST:
            words = f"a step of {step * FAST / turned[worst]:.2g} s would follow it"
            warnings.append(
                f"ours: at {t[worst]:.4g} s the contact {joint.name!r} turns by {turned[worst]:.2g} rad along its "
                f"curves in one step; {words}"
            )
    return warnings
