"""A Pin in pymunk: a pivot with two anchors, never one world point, so that an open joint stays visible.

A pin to the ground of a body that the ground drives is no constraint: see `engines.pymunk.joints.drive`.
"""

from __future__ import annotations

from collections.abc import Callable

import pymunk
from pymunk.constraints import PivotJoint

from reference.joints import Pin, Vector, Weld


def pin(
    joint: Pin | Weld, first: pymunk.Body, second: pymunk.Body, own: Callable[[str | None, Vector], Vector]
) -> PivotJoint:
    """Two rows that hold the two points together; `own(body, point)` is a point [m] from the engine's origin."""
    return PivotJoint(first, second, own(joint.first, joint.first_point), own(joint.second, joint.second_point))
