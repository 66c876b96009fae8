"""A Roll as a pivot in pymunk, moved along both curves before every step.

`CONSTRUCTIONS` names what can stand for a Roll:

- "contact": two shapes that press and rub (`engines.pymunk.outlines`).
- "pivot": a `PivotJoint` whose anchors, one on each curve, are set before every step where the curves will touch after
  its drift. Both are found by arc length from the start, so the gap it closes is the whole gap since the start.
- "stale pivot": the same where they touch now: half of the rolling acceleration is missing.
"""

from __future__ import annotations

from typing import Literal, get_args

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import PivotJoint

from engines.pymunk.contacts import Touch
from reference.joints import Vector
from reference.rolling.roll import Roll

RollConstruction = Literal["contact", "pivot", "stale pivot"]
CONSTRUCTIONS: tuple[str, ...] = get_args(RollConstruction)


class MovedPivot:
    """The pivot of one Roll, between any two bodies; `origins` [m] are the engine's in the mechanism's body frames."""

    def __init__(
        self,
        joint: Roll,
        first: pymunk.Body,
        second: pymunk.Body,
        origins: tuple[Vector, Vector],
        predicted: bool,
    ) -> None:
        self._touch = Touch(joint.rolling)
        self._bodies, self._predicted = (first._body, second._body), predicted
        self._from_first, self._from_second = origins
        self.constraint = PivotJoint(first, second, (0.0, 0.0), (0.0, 0.0))
        self._pointer = self.constraint._constraint

    def __call__(self, ahead: float) -> None:
        first, second = self._bodies
        if not self._predicted:
            ahead = 0.0
        rotation = lib.cpBodyGetAngle(second) - lib.cpBodyGetAngle(first)
        rotation += ahead * (lib.cpBodyGetAngularVelocity(second) - lib.cpBodyGetAngularVelocity(first))
        (x1, y1), (x2, y2) = self._touch.on_both(rotation)
        lib.cpPivotJointSetAnchorA(self._pointer, (x1 - self._from_first[0], y1 - self._from_first[1]))
        lib.cpPivotJointSetAnchorB(self._pointer, (x2 - self._from_second[0], y2 - self._from_second[1]))
