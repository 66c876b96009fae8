"""Constructions of a Roll in pymunk, by `RollConstruction`.

- "contact": two shapes with contact and friction, as a user would build them.
- "pivot": a `PivotJoint`. Before every step our code sets the anchors to the two points of the curves that will be in
  contact after the drift.
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
ToEngine = Callable[[Vector], Vector]  # converts a point of a mechanism's body frame to pymunk's body frame


def _shipped() -> tuple[float, float]:
    space = pymunk.Space()  # local, see `engines.pymunk.engine`
    return space.collision_slop, space.collision_bias


SHIPPED_SLOP, SHIPPED_BIAS = _shipped()  # The values are 0.1 and 0.9 ** 60.
GROUND_HALF_LENGTH = 1e3  # Half the length of flat ground, in multiples of `extent_of`.


@dataclass(frozen=True)
class ContactSettings(Valid):
    """Settings of contacts; raises ValueError for values with which pymunk aborts the process or returns NaN.

    `slop`: overlap [m] that is not corrected. `bias`: fraction of any further overlap that remains after one second.
    `friction`: coefficient of each shape; pymunk multiplies the two coefficients of a contact. `vertices`: number of
    corners, at equal arc lengths, of a body that is not round. `thickness`: radius of the segment whose surface is the
    flat ground, in multiples of `extent_of`. On a segment of zero thickness, Chipmunk sometimes computes a wrong normal
    for polygons of some hundred corners (`tests/engines/test_pymunk.py`).

    With the default settings the motion of a contact depends on the unit of length, since collision_slop is 0.1 units
    (pymunk 7.3.1). The angle of `rolling_ellipse` changes by 4e-3 rad if the unit is a millimetre.
    """

    slop: NonNegative = SHIPPED_SLOP
    bias: Fraction = SHIPPED_BIAS
    friction: NonNegative = 10.0  # the product, 100, is enough for all scenes
    vertices: Annotated[int, from_to(3, 10000)] = 64
    thickness: NonNegative = 0.1


SHIPPED_CONTACT = ContactSettings()


def extent_of(mechanism: Mechanism) -> float:
    """The size [m] of a mechanism, rounded to a power of ten, so that mechanisms of similar size have equal shapes."""
    return 10.0 ** round(math.log10(2 * mechanism.length_scale))


def contact_shapes(
    joint: Roll,
    contact: ContactSettings,
    extent: float,
    index: int,
    sides: tuple[tuple[pymunk.Body, ToEngine], tuple[pymunk.Body, ToEngine]],
) -> list[pymunk.Shape]:
    """The shapes of both curves, which collide only with each other.

    `extent` [m]: result of `extent_of`. `index`: number of the Roll in the mechanism, from 0. `sides`: both bodies,
    each with a function that converts a point [m] of the mechanism's body frame to pymunk's body frame.
    """
    if index >= 32:
        raise Unsupported(
            f"joint {joint.name!r}: pymunk's shape filter has 32 categories, one for each roll; this mechanism has more"
        )
    shapes = [
        _shape(joint, curve, body, to_engine, contact, extent)
        for curve, (body, to_engine) in zip((joint.rolling.ground, joint.rolling.body), sides, strict=True)
    ]
    for shape in shapes:
        shape.friction = contact.friction
        shape.filter = pymunk.ShapeFilter(categories=1 << index, mask=1 << index)
    return shapes


def _shape(
    joint: Roll, curve: Curve, body: pymunk.Body, to_engine: ToEngine, contact: ContactSettings, extent: float
) -> pymunk.Shape:
    inner, shift, turn = unplaced(curve)
    if isinstance(inner, Circle):
        centre = rect(1.0, turn) * complex(*inner.centre) + shift
        return pymunk.Circle(body, inner.radius, to_engine((centre.real, centre.imag)))
    if isinstance(inner, Line):
        along = rect(1.0, turn + inner.heading)
        thickness, half_length = contact.thickness * extent, GROUND_HALF_LENGTH * extent * along
        below = thickness * 1j * along  # material is to the left
        through = rect(1.0, turn) * complex(*inner.through) + shift + below
        back, front = (to_engine((end.real, end.imag)) for end in (through - half_length, through + half_length))
        return pymunk.Segment(body, back, front, thickness)
    if curve.curvature_range[0] < 0:
        raise Unsupported(
            f"joint {joint.name!r}: pymunk's shapes are convex, and a {type(inner).__name__} is hollow; our adapter "
            "builds no ring of segments"
        )
    if not math.isfinite(curve.length):
        raise Unsupported(f"joint {joint.name!r}: a {type(inner).__name__} is open, and a polygon is closed")
    corners = curve.point(np.linspace(0.0, curve.length, contact.vertices, endpoint=False))
    return pymunk.Poly(body, [to_engine((float(x), float(y))) for x, y in corners])


class MovedPivot:
    """The pivot of a Roll; `origins` [m] are the origins of the pymunk bodies in the mechanism's body frames."""

    def __init__(self, joint: Roll, first: pymunk.Body, second: pymunk.Body, origins: tuple[Vector, Vector]) -> None:
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
