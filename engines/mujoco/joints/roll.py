"""Constructions of a Roll in MuJoCo: contact with friction, or two rows that a callback writes in every stage.

The rows of a contact obey J a = -b J v - k gap. In 4.0.1 they lack the term -(dJ/dt) v of a curved or moving contact.
The error of the rolling velocity is therefore about a time constant times this term, and the order is at most 1.
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
from engines.mujoco.builder import ModelBuilder
from engines.mujoco.stiffness import STIFFEST, Shipped
from engines.rolling_table import rolled, unplaced
from reference.checks import InvalidMechanism, Positive, Valid
from reference.mechanism import Mechanism
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Ring
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

Array = NDArray[np.float64]
Cone = Literal["pyramidal", "elliptic"]
# Distance at which shapes collide, relative to the mechanism's length. The distance is above the rounding of a contact.
TOUCH = 1e-12
# A contact is lost if its reaction relative to the largest reaction is smaller than this. The limit is far above
# rounding.
NO_FORCE = 1e-9
# Largest rotation [rad] of a contact along the curves in a step. Methods of order 4 then reach their order.
MAX_CONTACT_TURN = 0.1


@dataclass(frozen=True)
class RollContact(Valid):
    """Settings of contact and friction, by default MuJoCo's values.

    `friction`: coefficient of friction. `steps`: time constant of the contact in steps, with the largest impedance;
    None for MuJoCo's 0.02 s. `stick`: make slip decay at the largest rate that the integrator allows, 2/dt for RK4 and
    1/dt for others. MuJoCo reads this rate (`solreffriction`) only with the elliptic cone (checked in
    `tests/engines/test_mujoco_rows.py`). Raises InvalidMechanism for `stick` with another cone.
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


def add_rolls(builder: ModelBuilder, rolls: Sequence[Roll]) -> None:
    by = builder.settings.rolls
    if isinstance(by, RollContact):
        _add_contacts(builder, rolls, by)
        return
    for roll in rolls:
        builder.add_user_rows("roll", roll, builder.gains, rolled(roll.rolling))


def _add_contacts(builder: ModelBuilder, rolls: Sequence[Roll], by: RollContact) -> None:
    spec, shipped = builder.spec, Shipped()
    reference, impedance = shipped.reference(builder.mechanism, builder.dt), shipped.impedance
    if by.steps is not None:
        reference, impedance = (by.steps * builder.dt, 1.0), STIFFEST
    for roll in rolls:
        pair = spec.add_pair(
            geomname1=_add_shape(builder, roll, roll.first, roll.rolling.ground),
            geomname2=_add_shape(builder, roll, roll.second, roll.rolling.body),
            condim=3,
            friction=[by.friction, by.friction, 0.005, 0.0001, 0.0001],  # condim 3 uses the first two values
            solref=list(reference),
            solimp=list(impedance),
            margin=TOUCH * builder.mechanism.length_scale,
        )
        if by.stick:
            runge_kutta = spec.option.integrator == mujoco.mjtIntegrator.mjINT_RK4
            pair.solreffriction = [-1e-9, -(2.0 if runge_kutta else 1.0) / builder.dt]
        builder.row_count += roll.size
    builder.needs_contacts = True
    spec.option.cone = getattr(mujoco.mjtCone, f"mjCONE_{by.cone.upper()}")


def _add_shape(builder: ModelBuilder, roll: Roll, owner: str | None, curve: Curve) -> str:
    """Add a plane, a sphere or an ellipsoid for the curve of a body, and return the name of the geom.

    A circle is a sphere, since a cylinder would touch at two points. Raises Unsupported for other curves.
    """
    curve, shift, angle = unplaced(curve)
    index, body = builder.index(owner), builder.spec_body(owner)
    start = 0.0 if index is None else builder.mechanism.bodies[index].pose[2]
    name = f"{roll.name}: {'ground' if owner is None else owner}"

    def add(kind: Any, centre: complex, quaternion: list[float], size: list[float]) -> str:
        point = rect(1.0, start) * (shift + rect(1.0, angle) * centre)
        # Only explicit pairs of geoms collide.
        no_other_contact: dict[str, Any] = {"mass": 0.0, "contype": 0, "conaffinity": 0}
        at = [point.real, point.imag, 0.0]
        body.add_geom(name=name, type=kind, pos=at, quat=quaternion, size=size, **no_other_contact)
        return name

    half = (start + angle) / 2
    turned = [math.cos(half), 0.0, 0.0, math.sin(half)]
    match curve:
        case Line() if owner is None:
            # The normal of a plane is its z axis, which points out of the material on the left of the line.
            normal, quarter = -1j * rect(1.0, curve.heading + angle), math.sqrt(0.5)
            upright = [quarter, -quarter * normal.imag, quarter * normal.real, 0.0]
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
            shape = type(curve).__name__.lower()
            raise Unsupported(
                f"roll {roll.name!r}: our adapter builds no shape like a {shape} in MuJoCo, but planes, circles and "
                "ellipses",
                lacking=f"our adapter builds no {shape}",
            )


def roll_warnings(
    mechanism: Mechanism, step: float, t: Array, pose: Array, twist: Array, reaction: Array
) -> list[RunWarning]:
    """Warnings if a contact is lost, or if it moves along the curves too fast for the step [s].

    t (times,); pose and twist (times, bodies, 3); reaction (times, rows). In a step the contact turns by omega dt /
    conformality, and this angle must be small.
    """
    warnings, begin = list[RunWarning](), 0

    def relative(states: Array, joint: Roll) -> Array:
        first, second = (
            0.0 if name is None else states[:, mechanism.body_index(name), 2] for name in (joint.first, joint.second)
        )
        return np.asarray(second - first)

    for joint in mechanism.joints if len(t) else ():
        force = np.abs(reaction[:, begin : begin + joint.size])
        begin += joint.size
        if not isinstance(joint, Roll):
            continue
        size = force.max(axis=1)
        is_lost = size <= NO_FORCE * size.max()
        if is_lost.any() or not size.max() > 0:
            share, first = np.count_nonzero(is_lost) / len(t), t[int(np.argmax(is_lost))]
            text = (
                f"ours: the contact {joint.name!r} was lost: it carries nothing in {share:.2g} of the samples, "
                f"first at {first:.4g} s"
            )
            warnings.append(RunWarning(text, "contact", "adapter", float(first)))
        turned = np.abs(relative(twist, joint)) * step / joint.rolling.contact(relative(pose, joint)).conformality
        worst = int(np.argmax(turned))
        if turned[worst] > MAX_CONTACT_TURN:
            text = (
                f"ours: at {t[worst]:.4g} s the contact {joint.name!r} turns by {turned[worst]:.2g} rad along its "
                f"curves in one step; a step of {step * MAX_CONTACT_TURN / turned[worst]:.2g} s would follow it"
            )
            warnings.append(RunWarning(text, "contact", "adapter", float(t[worst])))
    return warnings
