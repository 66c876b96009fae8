"""`engines.pymunk.projection` in machine code: the same rows, wants and least squares, for one step at a time.

Gaps and rows are those of the judge's compiled code, the only one there is; numpy's are the check of both.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit, types

from engines.lagrange.compiled.rows import rows
from engines.lagrange.flat import COLUMNS, ENDS, GAP, POSE, RATE, ROW, ROW_AT, ROWS, TWIST
from reference.row_system import RANK_TOLERANCE

DONE, BLOWN_UP = range(2)
LIST, TABLE = types.float64[::1], types.float64[:, ::1]
SIGNATURE = types.int64(types.int64[::1], LIST, types.complex128[:, ::1], TABLE, LIST, LIST, LIST)


def run(whole, real, cells, state, closed, root, out):
    """Fill `out` (columns) with what is to be added to the velocities of the centres of mass.

    `state` (bodies, 6): their poses and twists. `root` (columns): roots of the inverse inertias that take part.
    `closed` (rows) [1/s]: which part of a gap a second closes, in the order of the rows of `whole`.
    """
    pose, twist, count, width = whole[POSE], whole[TWIST], whole[ROWS], whole[COLUMNS] - 3
    for body in range(len(state)):
        for k in range(3):
            real[pose + 3 * body + k], real[twist + 3 * body + k] = state[body, k], state[body, 3 + k]
    rows(whole, real, cells, pose, twist, 0.0)
    matrix, wanted = np.zeros((count, width)), np.empty(count)
    end, record, total = whole[ENDS], whole[ROW_AT], 0.0
    for row in range(count):
        speed = 0.0
        for side in range(2):
            body = whole[record + side]
            for k in range(3):
                if body < width:
                    speed += real[end + k] * real[twist + body + k]
                    matrix[row, body + k] += real[end + k] * root[body + k]
            end += 3
        gap = closed[row] * real[whole[GAP] + row] if closed[row] != 0 else 0.0
        wanted[row] = real[whole[RATE] + row] - gap - speed
        size = 0.0
        for k in range(width):
            size += matrix[row, k] * matrix[row, k]
        # Rows of equal length, so that no unit of theirs decides which of them depend on others.
        scale = 1.0 / math.sqrt(size) if size > 0 else 0.0
        for k in range(width):
            matrix[row, k] *= scale
        total += wanted[row] + size
        wanted[row] *= scale
        record += ROW
    if not math.isfinite(total):
        return BLOWN_UP
    change = np.linalg.lstsq(matrix, wanted, RANK_TOLERANCE)[0]
    for k in range(width):
        out[k] = change[k] * root[k]
    return DONE


run = njit(SIGNATURE, cache=True, nogil=True, error_model="numpy")(run)
