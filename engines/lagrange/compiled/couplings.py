"""The rows of couplings, and the terms of coupled forces, as in `reference.couplings`.

A term is the angle of a body relative to another body, or the position of a body's point along another body's line.
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined, inner


@inner
def coupling_equations(system):
    bodies, equations, ends = system.bodies, system.equations, system.ends
    for index in range(len(system.terms)):
        term = system.terms[index]
        if term.row < 0:
            break
        equations[term.row].gap = equations[term.row].bias = 0.0
        for end in (ends[term.first_end], ends[term.second_end]):
            end.x = end.y = end.turn = 0.0
    for index in range(len(system.terms)):
        term = system.terms[index]
        if term.row < 0:
            break
        first, second, equation = bodies[term.first], bodies[term.second], equations[term.row]
        value, x, y, first_turn, second_turn = term_value(term, first, second)
        add_to_end(ends[term.first_end], -x, -y, first_turn)
        add_to_end(ends[term.second_end], x, y, second_turn)
        equation.gap += value - term.offset
        if term.sliding != 0:
            equation.bias += sliding_bias(term, first, second, x, y)


@inlined
def add_to_end(end, x, y, turn):
    end.x += x
    end.y += y
    end.turn += turn


@inlined
def sliding_bias(term, first, second, x, y):
    """The bias of a term along the line (x, y), which is fixed in the first body."""
    omega, spin = first.omega, second.omega
    bx = second.cos * term.second_x - second.sin * term.second_y
    by = second.sin * term.second_x + second.cos * term.second_y
    apart_x, apart_y = second.x + bx - first.x, second.y + by - first.y
    vx, vy = second.vx - spin * by - first.vx, second.vy + spin * bx - first.vy
    centripetal = spin * spin * (x * bx + y * by) + omega * omega * (x * apart_x + y * apart_y)
    return centripetal - 2 * omega * (x * vy - y * vx)


@inlined
def term_value(term, first, second):
    """The value of a term, and its derivatives by the second body's x and y, the first angle and the second angle.

    The derivatives by the first body's x and y have the opposite sign.
    """
    factor = term.factor
    if term.sliding == 0:
        return factor * (second.angle - first.angle), 0.0, 0.0, -factor, factor
    line = first.angle + term.line_angle
    x, y = factor * math.cos(line), factor * math.sin(line)
    ax = first.cos * term.first_x - first.sin * term.first_y
    ay = first.sin * term.first_x + first.cos * term.first_y
    bx = second.cos * term.second_x - second.sin * term.second_y
    by = second.sin * term.second_x + second.cos * term.second_y
    apart_x, apart_y = second.x + bx - first.x, second.y + by - first.y
    value = x * (apart_x - ax) + y * (apart_y - ay)
    return value, x, y, x * apart_y - y * apart_x, y * bx - x * by
