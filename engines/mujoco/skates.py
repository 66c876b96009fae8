"""Ideal skates and wheels in MuJoCo, which has no such joint: the constructions that people use, and written rows."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal

from engines.mujoco.construction import Building
from engines.mujoco.written_rows import Row, State, WrittenJoint
from reference.joints import Skate

SkateBy = Literal["rows"]


def add_skates(building: Building, skates: Sequence[Skate], by: SkateBy) -> None:
    """Add the skates to the model by this construction."""
    for skate in skates:
        # There is no gap to close, only slip that rounding leaves: it may take the motion's own time to die out, and a
        # faster damping would cost accuracy.
        damping = 1 / building.mechanism.time_scale
        first, second = building.index(skate.first), building.index(skate.second)
        building.written.append(WrittenJoint(first, second, 1, skate_rows(skate, damping)))


def skate_rows(skate: Skate, damping: float) -> Callable[[float, State, State], Sequence[Row]]:
    """The skate's row and -(dJ/dt) v - damping slip, see `reference.joints.Skate`."""
    (point_x, point_y), blade = skate.second_point, skate.angle
    sine_of, cosine_of = math.sin, math.cos

    def rows(_t: float, first: State, second: State) -> Sequence[Row]:
        x1, y1, _, vx1, vy1, omega1 = first
        x2, y2, angle, vx2, vy2, omega2 = second
        cosine, sine = cosine_of(angle), sine_of(angle)
        own_x, own_y = cosine * point_x - sine * point_y, sine * point_x + cosine * point_y
        ahead_x, ahead_y = cosine_of(angle + blade), sine_of(angle + blade)
        vx2, vy2 = vx2 - omega2 * own_y, vy2 + omega2 * own_x  # of the blade's point
        arm_x, arm_y = x2 + own_x - x1, y2 + own_y - y1
        rate_x, rate_y = vx2 - vx1 + omega1 * arm_y, vy2 - vy1 - omega1 * arm_x
        slip = ahead_x * rate_y - ahead_y * rate_x
        square = omega2 * omega2
        gain_x = omega1 * (vy2 - vy1) - square * own_x
        gain_y = -omega1 * (vx2 - vx1) - square * own_y
        changing = ahead_x * gain_y - ahead_y * gain_x - omega2 * (ahead_x * rate_x + ahead_y * rate_y)
        return (
            (
                ahead_y, -ahead_x, -arm_y * ahead_y - arm_x * ahead_x,
                -ahead_y, ahead_x, own_x * ahead_x + own_y * ahead_y,
                -changing - damping * slip,
            ),
        )  # fmt: skip

    return rows
