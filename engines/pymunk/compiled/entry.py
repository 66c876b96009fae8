"""`engines.pymunk.projection` in machine code, and the steps of the engine between projections: no Python in between.

Gaps, rows and the row system are those of the judge's compiled code, the only one there is; numpy's are the check of
all. The row system is factorised as the judge does, in O(bodies) for a chain. Where its pivots tell that rows nearly
depend on others, the same least squares by singular values as in numpy take its place.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, types

from engines.lagrange.compiled.inner import inner, straight
from engines.lagrange.compiled.rows import rows
from engines.lagrange.compiled.system import ALL, along, solved
from engines.lagrange.flat import (
    CHANGE,
    COLUMNS,
    ENDS,
    GAP,
    MOBILITY,
    PIVOT,
    PIVOTED,
    POSE,
    RATE,
    RIGHT,
    ROW,
    ROW_AT,
    ROWS,
    TOLD,
    TWIST,
    WHICH,
)
from engines.pymunk.compiled.calls import STEP, VISIT
from engines.pymunk.projection import NEARLY
from reference.row_system import RANK_TOLERANCE

DONE, BLOWN_UP = range(2)
STATE = 6  # of a body, as C copies it: place, angle, velocity, rate
LIST, TABLE, WHOLE = types.float64[::1], types.float64[:, ::1], types.int64[::1]
COUNT = types.int32[::1]
SIGNATURE = types.int64(
    *(WHOLE, LIST, types.complex128[:, ::1], LIST, types.int64, WHOLE, TABLE, types.float64),
    *(STEP, VISIT, WHOLE, LIST, LIST, COUNT, COUNT),
    *(types.float64, types.int64, types.int64, LIST),
)


@inner
def least_squares(whole, real):
    """Fill the change from the right side, by singular values: rows of equal length, so that no unit of theirs decides
    which of them depend on others.
    """
    count, width = whole[ROWS], whole[COLUMNS] - 3
    matrix, wanted = np.zeros((count, width)), np.empty(count)
    end, record = whole[ENDS], whole[ROW_AT]
    for row in range(count):
        for side in range(2):
            body = whole[record + side]
            for k in range(3):
                if body < width:
                    matrix[row, body + k] += real[end + k] * math.sqrt(real[whole[MOBILITY] + body + k])
            end += 3
        size = 0.0
        for k in range(width):
            size += matrix[row, k] * matrix[row, k]
        scale = 1.0 / math.sqrt(size) if size > 0 else 0.0
        for k in range(width):
            matrix[row, k] *= scale
        wanted[row] = scale * real[whole[RIGHT] + row]
        record += ROW
    change = np.linalg.lstsq(matrix, wanted, RANK_TOLERANCE)[0]
    for k in range(width):
        real[whole[CHANGE] + k] = change[k] * math.sqrt(real[whole[MOBILITY] + k])


@inner
def projected(whole, real, cells, closed, unmoved):
    """Fill the change with what is to be added to the twist, for the pose and the twist that stand there.

    `closed` (rows) [1/s]: which part of a gap a second closes, in the order of the rows of `whole`. `unmoved` of the
    rows join bodies of which no impulse moves any.
    """
    rows(whole, real, cells, whole[POSE], whole[TWIST], 0.0)
    total = 0.0
    for row in range(whole[ROWS]):
        gap = closed[row] * real[whole[GAP] + row] if closed[row] != 0 else 0.0
        wanted = real[whole[RATE] + row] - gap - along(whole, real, whole[TWIST], row)
        real[whole[RIGHT] + row] = wanted
        total += wanted
    if not math.isfinite(total):
        return BLOWN_UP
    whole[WHICH] = ALL
    solved(whole, real, True, False)
    left_out = 0
    for row in range(whole[ROWS]):
        if not real[whole[PIVOT] + row] > 0:
            left_out += 1
    if left_out > unmoved or not real[whole[TOLD] + PIVOTED] > NEARLY:
        least_squares(whole, real)
    return DONE


@inner
def corrected(whole, real, cells, closed, unmoved, order, origins, unit, state, velocities):
    """Project the velocities in a state of all bodies as C copies it, there and in what is to be copied back."""
    pose, twist = whole[POSE], whole[TWIST]
    for body in range(len(order)):
        at, x, y = STATE * order[body], origins[body, 0], origins[body, 1]
        angle, rate = state[at + 2], state[at + 5]
        c, s = math.cos(angle), math.sin(angle)
        out_x, out_y = x * c - y * s, x * s + y * c
        to = 3 * body
        real[pose + to], real[pose + to + 1], real[pose + to + 2] = state[at] - out_x, state[at + 1] - out_y, angle
        real[twist + to] = (state[at + 3] + rate * out_y) / unit
        real[twist + to + 1] = (state[at + 4] - rate * out_x) / unit
        real[twist + to + 2] = rate / unit
    done = projected(whole, real, cells, closed, unmoved)
    if done == DONE:
        # A crank, whose origin is not its centre, is moved by no impulse: its change is zero.
        for body in range(len(order)):
            for k in range(3):
                state[STATE * order[body] + 3 + k] += real[whole[CHANGE] + 3 * body + k] * unit
    for body in range(len(state) // STATE):
        for k in range(3):
            velocities[3 * body + k] = state[STATE * body + 3 + k]
    return done


@inner
def kept(values, to, new):
    """Append to the values; where they end then."""
    for k in range(len(new)):
        values[to + k] = new[k]
    return to + len(new)


def run(
    whole,
    real,
    cells,
    closed,
    unmoved,
    order,
    origins,
    unit,
    step,
    visit,
    pointers,
    state,
    velocities,
    read,
    written,
    dt,
    samples,
    every,
    values,
):
    """Project a space's velocities after each of `every` steps of every sample; once, with no step, for no samples.

    `order` (bodies): which of C's bodies is which of the mechanism; `origins` as in `engines.pymunk.projection`.
    `pointers`: the space; what copies a state, and its data; what sets velocities, and its data. `state` and
    `velocities`: what these read and write; `read` and `written`: how many numbers of them. `values` get a state, then
    for each sample velocities one step before, if there is more than one step, and a state.
    """
    whole, real = straight(whole), straight(real)
    space, getter, get_data, setter, set_data = pointers[0], pointers[1], pointers[2], pointers[3], pointers[4]
    read[0] = 0
    visit(space, getter, get_data)
    to = kept(values, 0, state) if samples > 0 else 0
    for index in range(max(samples * every, 1)):
        if samples > 0:
            step(space, dt)
            read[0] = 0
            visit(space, getter, get_data)
        done = corrected(whole, real, cells, closed, unmoved, order, origins, unit, state, velocities)
        written[0] = 0
        visit(space, setter, set_data)
        if samples == 0:
            return done
        left = every - 1 - index % every
        if left == 1:
            to = kept(values, to, velocities)
        elif left == 0:
            to = kept(values, to, state)
    return DONE


run = njit(SIGNATURE, cache=True, nogil=True, error_model="numpy")(run)
