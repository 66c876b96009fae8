"""A Pin, a Rod, a Gear and a Weld in pymunk: joints that it has, or, for a weld, two of them.

A pin is a pivot with two anchors, never one world point, so that an open joint stays visible. One to the ground of a
body that the ground drives is no constraint: see `engines.pymunk.joints.drive`.
"""

from __future__ import annotations

from collections.abc import Callable

import pymunk
from pymunk.constraints import Constraint, GearJoint, PinJoint, PivotJoint

from reference.joints import Gear, Pin, Rod, Vector, Weld

Own = Callable[[str | None, Vector], Vector]  # a point of a body [m], from the engine's origin


def pin(joint: Pin | Weld, first: pymunk.Body, second: pymunk.Body, own: Own) -> PivotJoint:
    """Two rows that hold the two points together."""
    return PivotJoint(first, second, own(joint.first, joint.first_point), own(joint.second, joint.second_point))


def rod(joint: Rod, first: pymunk.Body, second: pymunk.Body, own: Own) -> PinJoint:
    """One row along the line between two anchors. pymunk would take the distance at the start; the rod's is exact."""
    constraint = PinJoint(first, second, own(joint.first, joint.first_point), own(joint.second, joint.second_point))
    constraint.distance = joint.length
    return constraint


def gear(joint: Gear, first: pymunk.Body, second: pymunk.Body) -> GearJoint:
    """One row of angles. Chipmunk holds ratio angle_b - angle_a = phase (preStep in its cpGearJoint.c), so both invert.

    Its bias divides by the ratio, which is never zero here.
    """
    return GearJoint(first, second, joint.phase / joint.ratio, 1 / joint.ratio)


def weld(joint: Weld, first: pymunk.Body, second: pymunk.Body, own: Own) -> list[Constraint]:
    """A pivot, and a gear of ratio one."""
    return [pin(joint, first, second, own), GearJoint(first, second, joint.angle, 1.0)]
