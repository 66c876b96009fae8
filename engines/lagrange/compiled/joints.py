"""Gap, velocity row J and bias -(dJ/dt) v of each joint, as in `reference.joints`.

The second derivative of a gap is J a - bias. The arms (ax, ay) and (bx, by) lead from the bodies' centres to the
joint's points. (apart_x, apart_y) leads from the first body's centre to the second body's point.
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined
from engines.lagrange.compiled.couplings import coupling_equations
from engines.lagrange.compiled.rolling import roll_equations
from engines.lagrange.records import JointKind


@inlined
def set_bodies(bodies, pose, twist):
    for index in range(len(bodies) - 1):
        body, at = bodies[index], 3 * index
        body.x, body.y, body.angle = pose[at], pose[at + 1], pose[at + 2]
        body.vx, body.vy, body.omega = twist[at], twist[at + 1], twist[at + 2]
        body.cos, body.sin = math.cos(body.angle), math.sin(body.angle)


@inlined
def set_equations(system, t):
    """Set the ends, gaps and biases of all rows; the gap of a nonholonomic row is 0."""
    bodies, equations, ends = system.bodies, system.equations, system.ends
    for index in range(len(system.joints)):
        joint = system.joints[index]
        kind, row = joint.kind, joint.row
        first, second = bodies[joint.first], bodies[joint.second]
        if kind == JointKind.COUPLING:
            continue  # see `coupling_equations`
        if kind in (JointKind.DRIVE, JointKind.GEAR):
            angle_equation(joint, first, second, t, equations[row], ends, 2 * row)
            continue
        if kind == JointKind.ROLL:
            roll_equations(system, system.rolls[joint.roll], joint.roll, first, second, row)
            continue
        ax = first.cos * joint.first_x - first.sin * joint.first_y
        ay = first.sin * joint.first_x + first.cos * joint.first_y
        bx = second.cos * joint.second_x - second.sin * joint.second_y
        by = second.sin * joint.second_x + second.cos * joint.second_y
        if kind in (JointKind.PIN, JointKind.WELD):
            pin_equations(first, second, ax, ay, bx, by, equations, ends, row)
            if kind == JointKind.WELD:
                angle_equation(joint, first, second, t, equations[row + 2], ends, 2 * row + 4)
        elif kind == JointKind.ROD:
            rod_equation(joint, first, second, ax, ay, bx, by, equations[row], ends[2 * row], ends[2 * row + 1])
        else:
            line_equation(joint, first, second, ax, ay, bx, by, equations[row], ends[2 * row], ends[2 * row + 1])
    if len(system.terms) > 0:
        coupling_equations(system)


@inlined
def set_end(end, x, y, turn):
    end.x, end.y, end.turn = x, y, turn


@inlined
def angle_equation(joint, first, second, t, equation, ends, end):
    """The row of a drive, gear or weld: second angle = ratio * first angle + offset + rate * t."""
    ends[end].turn, ends[end + 1].turn = -joint.ratio, 1.0
    equation.gap = second.angle - joint.ratio * first.angle - (joint.offset + joint.rate * t)
    equation.bias = 0.0


@inlined
def pin_equations(first, second, ax, ay, bx, by, equations, ends, row):
    """The two points coincide: rows along x and y."""
    omega, spin = first.omega, second.omega
    end = 2 * row
    ends[end].x, ends[end].turn = -1.0, ay
    ends[end + 1].x, ends[end + 1].turn = 1.0, -by
    ends[end + 2].y, ends[end + 2].turn = -1.0, -ax
    ends[end + 3].y, ends[end + 3].turn = 1.0, bx
    x, y = equations[row], equations[row + 1]
    x.gap, y.gap = second.x + bx - first.x - ax, second.y + by - first.y - ay
    x.bias = spin * spin * bx - omega * omega * ax
    y.bias = spin * spin * by - omega * omega * ay


@inlined
def rod_equation(joint, first, second, ax, ay, bx, by, equation, at_first, at_second):
    """The distance between the two points is `length`; (x, y) is the direction from the first to the second point."""
    omega, spin = first.omega, second.omega
    x, y = second.x + bx - first.x - ax, second.y + by - first.y - ay
    distance = math.sqrt(x * x + y * y)
    x, y = x / distance, y / distance
    vx = second.vx - spin * by - first.vx + omega * ay
    vy = second.vy + spin * bx - first.vy - omega * ax
    across = x * vy - y * vx
    set_end(at_first, -x, -y, x * ay - y * ax)
    set_end(at_second, x, y, y * bx - x * by)
    equation.gap = distance - joint.length
    centripetal = spin * spin * (x * bx + y * by) - omega * omega * (x * ax + y * ay)
    equation.bias = centripetal - across * across / distance


@inlined
def line_equation(joint, first, second, ax, ay, bx, by, equation, at_first, at_second):
    """A slot keeps the second point on a line of the first body; a skate moves it along a line of the second body.

    (x, y) is the line's direction, and (-y, x) is its normal.
    """
    omega, spin = first.omega, second.omega
    apart_x, apart_y = second.x + bx - first.x, second.y + by - first.y
    angle = joint.angle + (first.angle if joint.kind == JointKind.SLOT else second.angle)
    x, y = math.cos(angle), math.sin(angle)
    vx = second.vx - spin * by - first.vx
    vy = second.vy + spin * bx - first.vy
    set_end(at_first, y, -x, -x * apart_x - y * apart_y)
    set_end(at_second, -y, x, y * by + x * bx)
    along = x * vx + y * vy
    relative_along = x * (vx + omega * apart_y) + y * (vy - omega * apart_x)
    centripetal = spin * spin * (x * by - y * bx)
    if joint.kind == JointKind.SLOT:
        equation.gap = x * (apart_y - ay) - y * (apart_x - ax)
        equation.bias = centripetal + omega * (along + relative_along)
    else:
        equation.gap = 0.0
        equation.bias = centripetal + omega * along + spin * relative_along
