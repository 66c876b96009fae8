"""What can stand for a Roll in pymunk: two shapes that press and rub, or a pivot moved along both curves.

`RollConstruction` names them:

- "contact": by contact and friction, the two curves as shapes, as a user would make them.
- "pivot": a `PivotJoint` whose anchors, one on each curve, are set before every step where the curves will touch after
  its drift. Both are found by arc length from the start, so the gap it closes is the whole gap since the start.
"""

from __future__ import annotations

import math
from cmath import rect
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import PivotJoint

from engines import Unsupported
from engines.rolling_table import rolled, unplaced
from reference.checks import Fraction, NonNegative, Valid
from reference.mechanism import Mechanism
from reference.rolling.curves import Circle, Curve, Line, Vector
from reference.rolling.roll import Roll
from reference.validators import from_to

RollConstruction = Literal["contact", "pivot"]


def _shipped() -> tuple[float, float]:
    """As pymunk sets them; the space ends with this function, see `engines.pymunk.engine`."""
    space = pymunk.Space()
    return space.collision_slop, space.collision_bias


SHIPPED_SLOP, SHIPPED_BIAS = _shipped()  # 0.1, 0.9 ** 60
REACH = 1e3  # half the length of flat ground, in the mechanism's extents


@dataclass(frozen=True)
class Contact(Valid):
    """How contact is set: `slop` [m] of overlap is left alone, the fraction `bias` of the rest is left after a second.

    `friction` of each shape (the engine multiplies the two); `vertices` of a body that is not round, equally far apart
    along its rim; `thickness` of flat ground, a part of the mechanism's extent (`extent_of`), as the radius of a
    segment that lies this deep. On ground without thickness a polygon of some hundred corners is at times given a wrong
    normal: it is thrown, or stops dead (`tests/engines/test_pymunk.py` has it). Raises ValueError for other
    values: the engine would abort the process, or give NaN.
    """

    slop: NonNegative = SHIPPED_SLOP
    bias: Fraction = SHIPPED_BIAS
    friction: NonNegative = 10.0  # a product of 100: no rolling here ever needs so much
    vertices: Annotated[int, from_to(3, 10000)] = 64
    thickness: NonNegative = 0.1


SHIPPED_CONTACT = Contact()


def extent_of(mechanism: Mechanism) -> float:
    """About how far a rolling body of the mechanism reaches across [m], to the next power of ten.

    It is for lengths that only have to be large or small enough: steps of ten leave them as they are, to the last bit,
    for all mechanisms of about one size.
    """
    return 10.0 ** round(math.log10(2 * mechanism.length_scale))


def touching(
    joint: Roll,
    contact: Contact,
    extent: float,
    index: int,
    sides: tuple[tuple[pymunk.Body, Callable[[Vector], Vector]], tuple[pymunk.Body, Callable[[Vector], Vector]]],
) -> list[pymunk.Shape]:
    """The shapes of both curves, that see each other only; `index` counts the mechanism's Rolls from 0.

    `extent` [m] is the mechanism's. `sides` are the first and second body, each with what gives a point from the
    engine's origin.
    """
    if index >= 32:
        raise Unsupported(f"joint {joint.name!r}: pymunk's shape filter tells 32 pairs apart, and this is one more")
    shapes = [
        _shape(joint, curve, body, own, contact, extent)
        for curve, (body, own) in zip((joint.rolling.ground, joint.rolling.body), sides, strict=True)
    ]
    for shape in shapes:
        shape.friction = contact.friction
        shape.filter = pymunk.ShapeFilter(categories=1 << index, mask=1 << index)
    return shapes


def _shape(
    joint: Roll, curve: Curve, body: pymunk.Body, own: Callable[[Vector], Vector], contact: Contact, extent: float
) -> pymunk.Shape:
    inner, shift, turn = unplaced(curve)
    if isinstance(inner, Circle):
        centre = rect(1.0, turn) * complex(*inner.centre) + shift
        return pymunk.Circle(body, inner.radius, own((centre.real, centre.imag)))
    if isinstance(inner, Line):
        along = rect(1.0, turn + inner.heading)
        thickness, reach = contact.thickness * extent, REACH * extent * along
        below = thickness * 1j * along  # material is to the left
        through = rect(1.0, turn) * complex(*inner.through) + shift + below
        back, front = (own((end.real, end.imag)) for end in (through - reach, through + reach))
        return pymunk.Segment(body, back, front, thickness)
    if curve.curvature_range[0] < 0:
        raise Unsupported(
            f"joint {joint.name!r}: pymunk's shapes are convex, and a {type(inner).__name__} is hollow: our adapter "
            "builds no hole of segments"
        )
    if not math.isfinite(curve.length):
        raise Unsupported(f"joint {joint.name!r}: a {type(inner).__name__} has no end, and a polygon closes")
    corners = curve.point(np.linspace(0.0, curve.length, contact.vertices, endpoint=False))
    return pymunk.Poly(body, [own((float(x), float(y))) for x, y in corners])


class MovedPivot:
    """The pivot of one Roll, between any two bodies; `origins` [m] are the engine's in the mechanism's body frames."""

    def __init__(
        self,
        joint: Roll,
        first: pymunk.Body,
        second: pymunk.Body,
        origins: tuple[Vector, Vector],
    ) -> None:
        self._contact = rolled(joint.rolling).contact
        self._bodies = (first._body, second._body)
        self._from_first, self._from_second = (complex(*origin) for origin in origins)
        self.constraint = PivotJoint(first, second, (0.0, 0.0), (0.0, 0.0))
        self._pointer = self.constraint._constraint

    def __call__(self, ahead: float) -> None:
        first, second = self._bodies
        rotation = lib.cpBodyGetAngle(second) - lib.cpBodyGetAngle(first)
        rotation += ahead * (lib.cpBodyGetAngularVelocity(second) - lib.cpBodyGetAngularVelocity(first))
        on_first, on_second = self._contact(rotation)
        on_first -= self._from_first
        on_second -= self._from_second
        lib.cpPivotJointSetAnchorA(self._pointer, (on_first.real, on_first.imag))
        lib.cpPivotJointSetAnchorB(self._pointer, (on_second.real, on_second.imag))
