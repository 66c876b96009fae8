"""What stands for a Slot in pymunk: a groove joint where it is exact, and a link across the line elsewhere.

- "exact": a `GrooveJoint` if the groove is in a body of known motion and its anchor at the centre of mass of the second
  body, or that body can't turn: then pushing along the normal moves the anchor along the normal. Else a `Link`.
- "groove": a `GrooveJoint` wherever the point is, as a user would. Off the centre of mass of a body that turns, its
  impulse is not the one that stops the motion across the groove, at any step, unless the arm from the centre of mass to
  the point lies along or across the groove: see `engines.pymunk.joints.link`; measured in `tests/test_pymunk_slots.py`.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, isinf, sin
from typing import Literal

import pymunk
from pymunk.constraints import Constraint, GrooveJoint

from engines.pymunk.joints.link import Link
from reference.joints import Slot, Vector

SlotConstruction = Literal["exact", "groove"]

# A groove ends, a slot does not: this many lengths of the mechanism from the middle. Rounding grows in proportion.
REACH = 1e3


def slide(
    joint: Slot,
    construction: SlotConstruction,
    first: pymunk.Body,
    second: pymunk.Body,
    first_point: Vector,
    second_point: Vector,
    length: float,
) -> tuple[list[Constraint], list[Callable[[float], None]]]:
    """Constraints and what to do before each step; points from the engine's origins, `length` [m] of the mechanism."""
    known = first.body_type != pymunk.Body.DYNAMIC
    if construction == "groove" or (known and groove_is_exact(second_point, turns=not isinf(second.moment))):
        along_x, along_y = REACH * length * cos(joint.line_angle), REACH * length * sin(joint.line_angle)
        back = (first_point[0] - along_x, first_point[1] - along_y)
        front = (first_point[0] + along_x, first_point[1] + along_y)
        return [GrooveJoint(first, second, back, front, second_point)], []
    link = Link(joint, first, second, second_point, first_point, reach=length)
    return [link.constraint], [link]


def groove_is_exact(point: Vector, turns: bool) -> bool:
    """Whether every normal is an eigenvector of a body's inverse mass at this point; `turns`: a push can turn it."""
    return point == (0.0, 0.0) or not turns
