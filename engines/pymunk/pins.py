"""An ideal hinge in pymunk: a pivot with two anchors, never one world point, so that an open joint stays visible."""

from __future__ import annotations

from collections.abc import Mapping

import pymunk
from pymunk.constraints import PivotJoint

from engines.pymunk.drives import Crank
from reference.joints import Pin, Vector


def pin(joint: Pin, first: pymunk.Body, second: pymunk.Body, cranks: Mapping[str, Crank]) -> PivotJoint:
    """Two rows that hold the two points together."""
    return PivotJoint(
        first,
        second,
        _anchor(joint.first, joint.first_point, cranks),
        _anchor(joint.second, joint.second_point, cranks),
    )


def _anchor(name: str | None, point: Vector, cranks: Mapping[str, Crank]) -> Vector:
    """The point [m] from the origin of the engine's body, which for a crank is its pin."""
    if name is None or name not in cranks:
        return point
    origin = cranks[name].own_point
    return (point[0] - origin[0], point[1] - origin[1])
