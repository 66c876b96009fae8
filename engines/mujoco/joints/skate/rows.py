"""The skate's row as written in every stage of an integrator, and as every other construction of it is made from."""

from __future__ import annotations

import math

from engines.mujoco.written_rows import Law, Row, State
from reference.joints import Skate


def skate_rows(skate: Skate, damping: float) -> Law:
    """The skate's row and -(dJ/dt) v - damping slip, see `reference.joints.Skate`."""
    return Law(skate_row, (*skate.second_point, skate.angle, damping))


def skate_row(numbers: tuple[float, float, float, float], first: State, second: State) -> Row:
    """Of a point on the second body [m], the blade's angle there [rad] and the damping of slip [1/s]."""
    point_x, point_y, blade, damping = numbers
    x1, y1, _, vx1, vy1, omega1 = first
    x2, y2, angle, vx2, vy2, omega2 = second
    cosine, sine = math.cos(angle), math.sin(angle)
    own_x, own_y = cosine * point_x - sine * point_y, sine * point_x + cosine * point_y
    ahead_x, ahead_y = math.cos(angle + blade), math.sin(angle + blade)
    vx2, vy2 = vx2 - omega2 * own_y, vy2 + omega2 * own_x  # of the blade's point
    arm_x, arm_y = x2 + own_x - x1, y2 + own_y - y1
    rate_x, rate_y = vx2 - vx1 + omega1 * arm_y, vy2 - vy1 - omega1 * arm_x
    slip = ahead_x * rate_y - ahead_y * rate_x
    square = omega2 * omega2
    gain_x = omega1 * (vy2 - vy1) - square * own_x
    gain_y = -omega1 * (vx2 - vx1) - square * own_y
    changing = ahead_x * gain_y - ahead_y * gain_x - omega2 * (ahead_x * rate_x + ahead_y * rate_y)
    return (
        ahead_y, -ahead_x, -arm_y * ahead_y - arm_x * ahead_x,
        -ahead_y, ahead_x, own_x * ahead_x + own_y * ahead_y,
        -changing - damping * slip,
    )  # fmt: skip
