"""Accelerations by gravity and force elements; the same forces as `reference.forces`."""

from __future__ import annotations

import math

from engines.lagrange.compiled.inner import inner
from engines.lagrange.flat import (
    COLUMNS,
    DAMPER,
    FORCE,
    FORCE_AT,
    FORCE_NUMBERS,
    FORCE_PARAMETERS,
    FORCED,
    FORCES,
    GRAVITY,
    MOBILITY,
    SPRING,
    TORQUE,
    TORSION_SPRING,
)


@inner
def free(whole, real, pose, twist, out):
    """Accelerations of all forces but those of joints, to `out`."""
    for body in range(out, out + whole[COLUMNS] - 3, 3):
        real[body], real[body + 1], real[body + 2] = real[whole[GRAVITY]], real[whole[GRAVITY] + 1], 0.0
    for force in range(whole[FORCES]):
        record, number = whole[FORCE_AT] + FORCED * force, whole[FORCE_NUMBERS] + FORCE_PARAMETERS * force
        kind, first, second = whole[record], whole[record + 1], whole[record + 2]
        size, other = real[number + 4], real[number + 5]
        if kind in (SPRING, DAMPER, FORCE):
            angle = real[pose + first + 2]
            c, d = math.cos(angle), math.sin(angle)
            angle = real[pose + second + 2]
            g, h = math.cos(angle), math.sin(angle)
            ax, ay = c * real[number] - d * real[number + 1], d * real[number] + c * real[number + 1]
            bx, by = g * real[number + 2] - h * real[number + 3], h * real[number + 2] + g * real[number + 3]
            if kind == FORCE:
                push(whole, real, out, second, size, other, bx * other - by * size)
                continue
            x = real[pose + second] + bx - real[pose + first] - ax
            y = real[pose + second + 1] + by - real[pose + first + 1] - ay
            if kind == SPRING:
                pull = size
                if other != 0:
                    pull -= size * other / math.sqrt(x * x + y * y)
            else:
                fast_x = real[twist + second] - real[twist + second + 2] * by
                fast_x -= real[twist + first] - real[twist + first + 2] * ay
                fast_y = real[twist + second + 1] + real[twist + second + 2] * bx
                fast_y -= real[twist + first + 1] + real[twist + first + 2] * ax
                pull = size * (x * fast_x + y * fast_y) / (x * x + y * y)
            x, y = -pull * x, -pull * y
            push(whole, real, out, second, x, y, bx * y - by * x)
            push(whole, real, out, first, -x, -y, ay * x - ax * y)
            continue
        if kind == TORQUE:
            torque = size
        elif kind == TORSION_SPRING:
            torque = -size * (real[pose + second + 2] - real[pose + first + 2] - other)
        else:
            torque = -size * (real[twist + second + 2] - real[twist + first + 2])
        push(whole, real, out, second, 0.0, 0.0, torque)
        push(whole, real, out, first, 0.0, 0.0, -torque)


@inner
def push(whole, real, out, body, x, y, torque):
    """What a force and a torque at the centre of mass add to a body's accelerations; the ground has no mobility."""
    mobility = whole[MOBILITY] + body
    real[out + body] += real[mobility] * x
    real[out + body + 1] += real[mobility + 1] * y
    real[out + body + 2] += real[mobility + 2] * torque
