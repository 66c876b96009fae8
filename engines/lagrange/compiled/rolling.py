"""The two rows of a Roll. Vectors are complex numbers, as in `engines.rolling_table`.

P(theta) is the place of the second body in the frame R of the first, at the rotation theta of the second against the
first; the pair is closed by r2 - r1 = R P.
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inner, merged
from engines.lagrange.records import RollingForm


@merged
def roll_equations(system, roll, number, first, second, row):
    """Set ends, gaps and biases of the rows along e_t and then e_n = -i e_t."""
    omega, spin = first.omega, second.omega
    place, once, twice, tangent, turning = contact(system, roll, number, second.angle - first.angle)
    frame = complex(first.cos, first.sin)
    place, once, twice, tangent = frame * place, frame * once, frame * twice, frame * tangent
    relative = spin - omega
    apart = complex(second.x - first.x, second.y - first.y) - place
    slip = complex(second.vx - first.vx, second.vy - first.vy) - 1j * omega * place - relative * once
    bias = -omega * omega * place + 2j * omega * relative * once + relative * relative * twice
    bias += 1j * (omega + relative * turning) * slip  # e_t turns too
    at_first = once - 1j * place
    for k in range(row, row + 2):
        x, y = tangent.real, tangent.imag
        one, other, equation = system.ends[2 * k], system.ends[2 * k + 1], system.equations[k]
        one.x, one.y, one.turn = -x, -y, x * at_first.real + y * at_first.imag
        other.x, other.y, other.turn = x, y, -x * once.real - y * once.imag
        equation.gap = x * apart.real + y * apart.imag
        equation.bias = x * bias.real + y * bias.imag
        tangent = -1j * tangent


@merged
def contact(system, roll, number, theta):
    """P, P', P'', the tangent e_t and its turning rate per radian, in the first body's frame; NaN without a cell."""
    turn = complex(math.cos(theta), math.sin(theta))
    if roll.form == RollingForm.ON_LINE:
        out = turn * roll.middle
        place = roll.origin + roll.along * (theta - roll.start) - out
        return place, roll.along - 1j * out, out, roll.along * (1 / abs(roll.along)), 0.0
    if roll.form == RollingForm.ON_ROUND:
        angle = roll.angle + roll.turning * (theta - roll.start)
        tangent = complex(math.cos(angle), math.sin(angle))
        radius, out = roll.radius * tangent, turn * roll.middle
        place = roll.origin + roll.along * tangent - out
        return place, 1j * (radius - out), out - roll.turning * radius, tangent, roll.turning
    position = theta / roll.width
    index = math.floor(position) - roll.first_cell if abs(position) < 1e15 else -1
    if index < 0 or index >= roll.cell_count or math.isnan(system.cells[roll.cell_begin + index, 0].real):
        if not math.isnan(theta):
            system.status.missing_roll, system.status.missing_angle = number, theta
        lost = complex(math.nan, math.nan)
        return lost, lost, lost, lost, math.nan
    return tabulated_contact(system.cells, roll.cell_begin + index, theta)


@inner
def tabulated_contact(cells, cell, theta):
    """`contact` by the polynomials of a cell: its middle, P and P' there, the coefficients of P'', of P' and of P.

    P'' = s' e_n - a, and the arm a is -i P'.
    """
    u = theta - cells[cell, 0].real
    place = once = twice = thrice = 0j
    for k in range(19, 13, -1):
        place = place * u + cells[cell, k]
    for k in range(13, 8, -1):
        once = once * u + cells[cell, k]
    for k in range(8, 2, -1):
        twice = twice * u + cells[cell, k]
    for k in range(8, 3, -1):
        thrice = thrice * u + (k - 3) * cells[cell, k]
    place = (place * u + cells[cell, 2]) * u + cells[cell, 1]
    once = (once * u + cells[cell, 3]) * u + cells[cell, 2]
    normal = twice - 1j * once
    length = abs(normal)
    turning = (normal.conjugate() * (thrice - 1j * twice)).imag / (length * length)
    return place, once, twice, normal * (1j / length), turning
