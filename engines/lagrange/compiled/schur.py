"""The Schur complement of the KKT system, J M^-1 J^T reaction = right, in its envelope: O(bodies) for a chain.

The factor L D L^T needs no scaling, since scaling rows changes no digit of it; a pivot is compared with the row's own
diagonal, and tells what part of the row the earlier ones leave. Where nothing is left the row follows from them, and
its reaction is set to zero: what moves is the same. The product has the square of J's condition, so wherever a pivot is
small, what the reactions miss of the right side is solved for once more, by J itself (corrected seminormal equations,
Bjorck 1987).
"""

from __future__ import annotations

import math

from engines.lagrange.arrays import (
    CHANGE,
    COLUMNS,
    COMPLIANCE,
    DEPENDENT,
    ENDS,
    EXTRA,
    EXTRA_AT,
    EXTRAS,
    FELT,
    LEFT,
    MATRIX,
    MOBILITY,
    PIVOT,
    PIVOTED,
    REACTION,
    RIGHT,
    ROW,
    ROW_AT,
    ROWS,
    SMALLEST,
    SOFT,
    STATUS,
    TERM,
    TERM_AT,
    TERMS,
    WHICH,
)
from engines.lagrange.compiled.inner import inner

# Pivots below which a row follows from others. Where rows are independent at the start: the rounding of the product,
# times a thousand. Where some are not: their dependence is blurred by as much, squared, as joints are open in a step,
# so this is RANK_TOLERANCE of `reference.rows`.
ROUNDING, BLURRED = 1e-13, 1e-9
EASY = 1e-2  # above, rounding costs less than two digits, and nothing is corrected
FEW_ROWS = 24  # the condition of a long chain shows in no pivot, so more rows than this are always corrected once
MOST_CORRECTIONS = 4
LEAST_FELT = 0.1  # see `assemble_soft`

# Which rows are asked for; the others are kept apart, with a diagonal of one. It stands among the whole numbers, since
# an argument that is a constant would have each function compiled once for every value.
ALL, HOLONOMIC, RIGID = range(3)


@inner
def left_out(whole, real, row):
    """Whether a row is not one of those that are asked for."""
    which = whole[WHICH]
    if which == HOLONOMIC:
        return whole[whole[ROW_AT] + ROW * row + 2] == 0
    return which == RIGID and real[whole[COMPLIANCE] + row] > 0


@inner
def assemble(whole, real):
    """Fill the envelope with J M^-1 J^T."""
    ends, mobility, matrix = whole[ENDS], whole[MOBILITY], whole[MATRIX]
    for entry in range(matrix, whole[CHANGE]):
        real[entry] = 0.0
    before, x, y, turn = -1, 0.0, 0.0, 0.0
    for term in range(whole[TERM_AT], whole[TERM_AT] + TERM * whole[TERMS], TERM):
        one, other = ends + whole[term + 1], ends + whole[term + 2]
        if one != before:  # terms of one end stand together
            body, before = mobility + whole[term + 3], one
            x, y, turn = real[one] * real[body], real[one + 1] * real[body + 1], real[one + 2] * real[body + 2]
        real[matrix + whole[term]] += x * real[other] + y * real[other + 1] + turn * real[other + 2]


@inner
def factorise(whole, real):
    """Make the factor of what is assembled; the smallest pivot that is used, as a part of its row's diagonal."""
    matrix, pivots, records = whole[MATRIX], whole[PIVOT], whole[ROW_AT]
    limit = BLURRED if whole[DEPENDENT] > 0 else ROUNDING
    smallest, record = 1.0, records
    for row in range(whole[ROWS]):
        first = whole[record + 3]
        own = matrix + whole[record + 4] - first
        if whole[WHICH] != ALL:
            out = left_out(whole, real, row)
            for column in range(first, row):
                if out or left_out(whole, real, column):
                    real[own + column] = 0.0
            if out:
                real[own + row] = 1.0
        rest = diagonal = real[own + row]
        for column in range(first, row):
            begin = whole[records + ROW * column + 3]
            other = matrix + whole[records + ROW * column + 4] - begin
            value = real[own + column]
            for k in range(max(first, begin), column):
                value -= real[own + k] * real[other + k]
            real[own + column] = value
        for column in range(first, row):
            value = real[own + column]
            real[own + column] = value * real[pivots + column]
            rest -= value * real[own + column]
        if rest > limit * diagonal:
            smallest = min(smallest, rest / diagonal)
            real[pivots + row] = 1.0 / rest
        else:
            real[pivots + row] = 0.0 if rest <= limit * diagonal else math.nan
        record += ROW
    return smallest


@inner
def substitute(whole, real, right):
    """Replace the vector at `right` by the solution of L D L^T x = right.

    What one row hands to the next stays in a register: through memory it would take half of the time.
    """
    rows, record, pivots, matrix = whole[ROWS], whole[ROW_AT], whole[PIVOT], whole[MATRIX]
    before = 0.0
    for row in range(rows):
        first, value = whole[record + 3], real[right + row]
        own = matrix + whole[record + 4] - first
        for column in range(first, row - 1):
            value -= real[own + column] * real[right + column]
        if first < row:
            value -= real[own + row - 1] * before
        real[right + row] = before = value
        record += ROW
    for row in range(rows):
        real[right + row] *= real[pivots + row]
    value = real[right + rows - 1]
    for row in range(rows - 1, 0, -1):
        record -= ROW
        first, before = whole[record + 3], real[right + row - 1]
        own = matrix + whole[record + 4] - first
        if first < row:
            before -= real[own + row - 1] * value
        for column in range(first, row - 1):
            real[right + column] -= real[own + column] * value
        real[right + row - 1] = value = before


@inner
def apply_reactions(whole, real):
    """Fill the change with M^-1 J^T reaction."""
    change, end, record = whole[CHANGE], whole[ENDS], whole[ROW_AT]
    for k in range(whole[COLUMNS]):
        real[change + k] = 0.0
    for row in range(whole[ROWS]):
        value = real[whole[REACTION] + row]
        for side in range(2):
            body = change + whole[record + side]
            real[body] += real[end] * value
            real[body + 1] += real[end + 1] * value
            real[body + 2] += real[end + 2] * value
            end += 3
        record += ROW
    for extra in range(whole[EXTRA_AT], whole[EXTRA_AT] + EXTRA * whole[EXTRAS], EXTRA):
        value = real[whole[REACTION] + whole[extra]]
        body, end = change + whole[extra + 1], whole[ENDS] + whole[extra + 2]
        real[body] += real[end] * value
        real[body + 1] += real[end + 1] * value
        real[body + 2] += real[end + 2] * value
    for k in range(whole[COLUMNS]):
        real[change + k] *= real[whole[MOBILITY] + k]


@inner
def row_times(whole, real, vector, row):
    """J of one row times the vector of columns that stands at `vector`."""
    end, record = whole[ENDS] + 6 * row, whole[ROW_AT] + ROW * row
    one, other = vector + whole[record], vector + whole[record + 1]
    value = (
        real[end] * real[one]
        + real[end + 1] * real[one + 1]
        + real[end + 2] * real[one + 2]
        + real[end + 3] * real[other]
        + real[end + 4] * real[other + 1]
        + real[end + 5] * real[other + 2]
    )
    for extra in range(whole[EXTRA_AT], whole[EXTRA_AT] + EXTRA * whole[EXTRAS], EXTRA):
        if whole[extra] == row:
            body, end = vector + whole[extra + 1], whole[ENDS] + whole[extra + 2]
            value += real[end] * real[body] + real[end + 1] * real[body + 1] + real[end + 2] * real[body + 2]
    return value


@inner
def residual(whole, real, vector, right, out):
    """Fill `out` with what J times the vector of columns lacks of the right side."""
    for row in range(whole[ROWS]):
        real[out + row] = real[right + row] - row_times(whole, real, vector, row)


@inner
def solve(whole, real, small, kept):
    """Fill the change with the least one, by mass, along which J changes by the right side, and its reactions.

    `small`: of a change that is itself a correction, so that a long chain's digits need none. `kept`: with the factor
    of the call before, for rows that have hardly turned since: one correction makes up for it.
    """
    rows, reaction, left, status = whole[ROWS], whole[REACTION], whole[LEFT], whole[STATUS]
    right, pivots, some = whole[RIGHT], whole[PIVOT], whole[WHICH] != ALL
    soft_rows = whole[SOFT] > 1 and not some
    pivot = real[status + PIVOTED]
    if not kept or pivot < EASY:
        if soft_rows:
            assemble_soft(whole, real)
        else:
            assemble(whole, real)
        pivot = factorise(whole, real)
        real[status + PIVOTED] = pivot
    real[status + SMALLEST] = min(real[status + SMALLEST], pivot)
    for row in range(rows):
        real[reaction + row] = 0.0 if some and left_out(whole, real, row) else real[right + row]
    substitute(whole, real, reaction)
    apply_reactions(whole, real)
    if (pivot > EASY and not kept and (small or rows <= FEW_ROWS)) or soft_rows:
        return  # reactions of soft rows miss the right side on purpose
    before = math.inf
    for _ in range(MOST_CORRECTIONS if pivot < EASY else 1):
        largest = 0.0
        residual(whole, real, whole[CHANGE], right, left)
        for row in range(rows):
            if some and left_out(whole, real, row):
                real[left + row] = 0.0
            missing = real[left + row]
            largest = max(largest, missing * missing * real[pivots + row])
        if not 0 < largest < 0.25 * before:
            return
        before = largest
        substitute(whole, real, left)
        for row in range(rows):
            real[reaction + row] += real[left + row]
        apply_reactions(whole, real)


@inner
def assemble_soft(whole, real):
    """Assemble, and add to the diagonal of each soft row its compliance, in parts of what the row feels.

    That is its inverse inertia while the rigid rows hold: the diagonal of the Schur complement. Of a row that others
    hold already LEAST_FELT is left, since engines take an estimate that knows no others.
    """
    rows, reaction, left = whole[ROWS], whole[REACTION], whole[LEFT]
    assemble(whole, real)
    whole[WHICH] = RIGID
    factorise(whole, real)
    for soft in range(rows):
        if left_out(whole, real, soft):
            for row in range(rows):
                real[reaction + row] = 1.0 if row == soft else 0.0
            apply_reactions(whole, real)
            felt = own = row_times(whole, real, whole[CHANGE], soft)
            for row in range(rows):
                rigid = not left_out(whole, real, row)
                real[left + row] = row_times(whole, real, whole[CHANGE], row) if rigid else 0.0
            substitute(whole, real, left)
            for row in range(rows):
                felt -= real[left + row] * row_times(whole, real, whole[CHANGE], row)
            real[whole[FELT] + soft] = max(felt, LEAST_FELT * own)
    whole[WHICH] = ALL
    assemble(whole, real)
    for row in range(rows):
        record = whole[ROW_AT] + ROW * row
        diagonal = whole[MATRIX] + whole[record + 4] + row - whole[record + 3]
        real[diagonal] += real[whole[COMPLIANCE] + row] * real[whole[FELT] + row]
