"""An ideal hinge in pymunk: a pivot with two anchors, never one world point, so that an open joint stays visible."""

from __future__ import annotations

import pymunk
from pymunk.constraints import PivotJoint

from reference.joints import Vector


def pin(first: pymunk.Body, second: pymunk.Body, first_anchor: Vector, second_anchor: Vector) -> PivotJoint:
    """Two rows that hold the two points together; anchors [m] are from the origins of the engine's bodies."""
    return PivotJoint(first, second, first_anchor, second_anchor)
