"""Accelerations under gravity and force elements, as in `reference.forces`."""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined, inner, merged
from engines.lagrange.compiled.couplings import term_value
from engines.lagrange.records import ForceKind


@merged
def applied_accelerations(system, out):
    """Set `out` (coordinates,) to the accelerations that the bodies would have without joints."""
    bodies = system.bodies
    for at in range(0, 3 * (len(bodies) - 1), 3):
        out[at], out[at + 1], out[at + 2] = system.constants.gravity_x, system.constants.gravity_y, 0.0
    for index in range(len(system.forces)):
        force = system.forces[index]
        kind = force.kind
        if kind == ForceKind.COUPLED_FORCE:
            coupled_force(system, force, out)
            continue
        first, second = bodies[force.first], bodies[force.second]
        if kind in (ForceKind.SPRING, ForceKind.DAMPER, ForceKind.FORCE):
            point_force(bodies, force, first, second, out)
            continue
        if kind == ForceKind.TORQUE:
            torque = force.load
        elif kind == ForceKind.TORSION_SPRING:
            torque = -force.stiffness * (second.angle - first.angle - force.rest)
        else:
            torque = -force.damping * (second.omega - first.omega)
        push(bodies, force.second, 0.0, 0.0, torque, out)
        push(bodies, force.first, 0.0, 0.0, -torque, out)


@inlined
def point_force(bodies, force, first, second, out):
    """Add a constant force at the second point, or a spring or damper between both points."""
    ax = first.cos * force.first_x - first.sin * force.first_y
    ay = first.sin * force.first_x + first.cos * force.first_y
    bx = second.cos * force.second_x - second.sin * force.second_y
    by = second.sin * force.second_x + second.cos * force.second_y
    if force.kind == ForceKind.FORCE:
        push(bodies, force.second, force.x, force.y, bx * force.y - by * force.x, out)
        return
    x, y = second.x + bx - first.x - ax, second.y + by - first.y - ay
    if force.kind == ForceKind.SPRING:
        pull = force.stiffness  # over the distance
        if force.rest != 0:
            pull -= force.stiffness * force.rest / math.sqrt(x * x + y * y)
    else:
        vx = second.vx - second.omega * by - (first.vx - first.omega * ay)
        vy = second.vy + second.omega * bx - (first.vy + first.omega * ax)
        pull = force.damping * (x * vx + y * vy) / (x * x + y * y)
    x, y = -pull * x, -pull * y
    push(bodies, force.second, x, y, bx * y - by * x, out)
    push(bodies, force.first, -x, -y, ay * x - ax * y, out)


@inner
def coupled_force(system, force, out):
    """Add a force along the gradient of a sum of terms; its size depends on the sum and the rate of the sum."""
    bodies, last = system.bodies, force.first_term + force.term_count
    strength = force.load + force.stiffness * force.rest
    for index in range(force.first_term, last):
        term = system.terms[index]
        first, second = bodies[term.first], bodies[term.second]
        value, x, y, first_turn, second_turn = term_value(term, first, second)
        rate = x * (second.vx - first.vx) + y * (second.vy - first.vy)
        rate += first_turn * first.omega + second_turn * second.omega
        strength -= force.stiffness * value + force.damping * rate
    for index in range(force.first_term, last):
        term = system.terms[index]
        _, x, y, first_turn, second_turn = term_value(term, bodies[term.first], bodies[term.second])
        push(bodies, term.first, -x * strength, -y * strength, first_turn * strength, out)
        push(bodies, term.second, x * strength, y * strength, second_turn * strength, out)


@inlined
def push(bodies, index, x, y, torque, out):
    """Add the acceleration of a body due to a force and a torque at its centre of mass; zero for the ground."""
    body, at = bodies[index], 3 * index
    out[at] += body.inverse_mass * x
    out[at + 1] += body.inverse_mass * y
    out[at + 2] += body.inverse_inertia * torque
