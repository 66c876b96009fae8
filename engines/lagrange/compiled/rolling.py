"""The two rows of a Roll. Vectors are complex numbers, as in `engines.rolling_table`.

P(theta) is the position of the second body in the frame R of the first body, and theta is the relative rotation. The
joint is closed if r2 - r1 = R P.
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inner, merged
from engines.lagrange.records import RollingForm


@merged
def roll_equations(system, roll, number, first, second, row):
    """Set the ends, gaps and biases of the two rows, along e_t and e_n = -i e_t."""
    omega, spin = first.omega, second.omega
    position, once, twice, tangent, turning = contact(system, roll, number, second.angle - first.angle)
    frame = complex(first.cos, first.sin)
    position, once, twice, tangent = frame * position, frame * once, frame * twice, frame * tangent
    relative = spin - omega
    gap = complex(second.x - first.x, second.y - first.y) - position
    slip = complex(second.vx - first.vx, second.vy - first.vy) - 1j * omega * position - relative * once
    bias = -omega * omega * position + 2j * omega * relative * once + relative * relative * twice
    bias += 1j * (omega + relative * turning) * slip  # e_t turns too
    arm = once - 1j * position
    for k in range(row, row + 2):
        x, y = tangent.real, tangent.imag
        at_first, at_second, equation = system.ends[2 * k], system.ends[2 * k + 1], system.equations[k]
        at_first.x, at_first.y, at_first.turn = -x, -y, x * arm.real + y * arm.imag
        at_second.x, at_second.y, at_second.turn = x, y, -x * once.real - y * once.imag
        equation.gap = x * gap.real + y * gap.imag
        equation.bias = x * bias.real + y * bias.imag
        tangent = -1j * tangent


@merged
def contact(system, roll, number, theta):
    """P, P', P'', the tangent e_t and its rotation per radian, in the first body's frame, or NaN without a cell."""
    turn = complex(math.cos(theta), math.sin(theta))
    if roll.form == RollingForm.ON_LINE:
        out = turn * roll.middle
        position = roll.origin + roll.along * (theta - roll.start) - out
        return position, roll.along - 1j * out, out, roll.along * (1 / abs(roll.along)), 0.0
    if roll.form == RollingForm.ON_ROUND:
        angle = roll.angle + roll.turning * (theta - roll.start)
        tangent = complex(math.cos(angle), math.sin(angle))
        radius, out = roll.radius * tangent, turn * roll.middle
        position = roll.origin + roll.along * tangent - out
        return position, 1j * (radius - out), out - roll.turning * radius, tangent, roll.turning
    cells_from_zero = theta / roll.width
    index = math.floor(cells_from_zero) - roll.first_cell if abs(cells_from_zero) < 1e15 else -1
    if index < 0 or index >= roll.cell_count or math.isnan(system.cells[roll.cell_begin + index, 0].real):
        if not math.isnan(theta):
            system.status.missing_roll, system.status.missing_angle = number, theta
        unknown = complex(math.nan, math.nan)
        return unknown, unknown, unknown, unknown, math.nan
    return tabulated_contact(system.cells, roll.cell_begin + index, theta)


@inner
def tabulated_contact(cells, cell, theta):
    """The result of `contact` from the polynomials of a cell (see `engines.rolling_table.Table`).

    P'' = s' e_n - a, and the arm is a = -i P'.
    """
    u = theta - cells[cell, 0].real
    position = once = twice = thrice = 0j
    for k in range(19, 13, -1):
        position = position * u + cells[cell, k]
    for k in range(13, 8, -1):
        once = once * u + cells[cell, k]
    for k in range(8, 2, -1):
        twice = twice * u + cells[cell, k]
    for k in range(8, 3, -1):
        thrice = thrice * u + (k - 3) * cells[cell, k]
    position = (position * u + cells[cell, 2]) * u + cells[cell, 1]
    once = (once * u + cells[cell, 3]) * u + cells[cell, 2]
    normal = twice - 1j * once
    length = abs(normal)
    turning = (normal.conjugate() * (thrice - 1j * twice)).imag / (length * length)
    return position, once, twice, normal * (1j / length), turning
