"""The Schur complement of the KKT system, J M^-1 J^T reaction = right, in its envelope: O(bodies) for a chain.

The factor L D L^T needs no scaling, since scaling rows changes no digit of it; a pivot is compared with the row's own
diagonal, and tells what part of the row the earlier ones leave. Where nothing is left the row follows from them, and
its reaction is set to zero: what moves is the same. The product has the square of J's condition, so wherever a pivot is
small, what the reactions miss of the right side is solved for once more, by J itself (corrected seminormal equations,
Bjorck 1987).
"""

from __future__ import annotations

import math

from engines.lagrange import arrays as ix
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
    which = whole[ix.WHICH]
    if which == HOLONOMIC:
        return whole[whole[ix.ROW_AT] + ix.ROW * row + 2] == 0
    return which == RIGID and real[whole[ix.COMPLIANCE] + row] > 0


@inner
def assemble(whole, real):
    """Fill the envelope with J M^-1 J^T."""
    ends, mobility, matrix = whole[ix.ENDS], whole[ix.MOBILITY], whole[ix.MATRIX]
    for entry in range(matrix, whole[ix.CHANGE]):
        real[entry] = 0.0
    before, x, y, turn = -1, 0.0, 0.0, 0.0
    for term in range(whole[ix.TERM_AT], whole[ix.TERM_AT] + ix.TERM * whole[ix.TERMS], ix.TERM):
        one, other = ends + whole[term + 1], ends + whole[term + 2]
        if one != before:  # terms of one end stand together
            body, before = mobility + whole[term + 3], one
            x, y, turn = real[one] * real[body], real[one + 1] * real[body + 1], real[one + 2] * real[body + 2]
        real[matrix + whole[term]] += x * real[other] + y * real[other + 1] + turn * real[other + 2]


@inner
def factorise(whole, real):
    """Make the factor of what is assembled; the smallest pivot that is used, as a part of its row's diagonal."""
    matrix, pivots, records = whole[ix.MATRIX], whole[ix.PIVOT], whole[ix.ROW_AT]
    limit = BLURRED if whole[ix.DEPENDENT] > 0 else ROUNDING
    smallest, record = 1.0, records
    for row in range(whole[ix.ROWS]):
        first = whole[record + 3]
        own = matrix + whole[record + 4] - first
        if whole[ix.WHICH] != ALL:
            out = left_out(whole, real, row)
            for column in range(first, row):
                if out or left_out(whole, real, column):
                    real[own + column] = 0.0
            if out:
                real[own + row] = 1.0
        rest = diagonal = real[own + row]
        for column in range(first, row):
            begin = whole[records + ix.ROW * column + 3]
            other = matrix + whole[records + ix.ROW * column + 4] - begin
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
        record += ix.ROW
    return smallest


@inner
def substitute(whole, real, right):
    """Replace the vector at `right` by the solution of L D L^T x = right.

    What one row hands to the next stays in a register: through memory it would take half of the time.
    """
    rows, record, pivots, matrix = whole[ix.ROWS], whole[ix.ROW_AT], whole[ix.PIVOT], whole[ix.MATRIX]
    before = 0.0
    for row in range(rows):
        first, value = whole[record + 3], real[right + row]
        own = matrix + whole[record + 4] - first
        for column in range(first, row - 1):
            value -= real[own + column] * real[right + column]
        if first < row:
            value -= real[own + row - 1] * before
        real[right + row] = before = value
        record += ix.ROW
    for row in range(rows):
        real[right + row] *= real[pivots + row]
    value = real[right + rows - 1]
    for row in range(rows - 1, 0, -1):
        record -= ix.ROW
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
    change, end, record = whole[ix.CHANGE], whole[ix.ENDS], whole[ix.ROW_AT]
    for k in range(whole[ix.COLUMNS]):
        real[change + k] = 0.0
    for row in range(whole[ix.ROWS]):
        value = real[whole[ix.REACTION] + row]
        for side in range(2):
            body = change + whole[record + side]
            real[body] += real[end] * value
            real[body + 1] += real[end + 1] * value
            real[body + 2] += real[end + 2] * value
            end += 3
        record += ix.ROW
    for extra in range(whole[ix.EXTRA_AT], whole[ix.EXTRA_AT] + ix.EXTRA * whole[ix.EXTRAS], ix.EXTRA):
        value = real[whole[ix.REACTION] + whole[extra]]
        body, end = change + whole[extra + 1], whole[ix.ENDS] + whole[extra + 2]
        real[body] += real[end] * value
        real[body + 1] += real[end + 1] * value
        real[body + 2] += real[end + 2] * value
    for k in range(whole[ix.COLUMNS]):
        real[change + k] *= real[whole[ix.MOBILITY] + k]


@inner
def row_times(whole, real, vector, row):
    """J of one row times the vector of columns that stands at `vector`."""
    end, record = whole[ix.ENDS] + 6 * row, whole[ix.ROW_AT] + ix.ROW * row
    one, other = vector + whole[record], vector + whole[record + 1]
    value = (
        real[end] * real[one]
        + real[end + 1] * real[one + 1]
        + real[end + 2] * real[one + 2]
        + real[end + 3] * real[other]
        + real[end + 4] * real[other + 1]
        + real[end + 5] * real[other + 2]
    )
    for extra in range(whole[ix.EXTRA_AT], whole[ix.EXTRA_AT] + ix.EXTRA * whole[ix.EXTRAS], ix.EXTRA):
        if whole[extra] == row:
            body, end = vector + whole[extra + 1], whole[ix.ENDS] + whole[extra + 2]
            value += real[end] * real[body] + real[end + 1] * real[body + 1] + real[end + 2] * real[body + 2]
    return value


@inner
def residual(whole, real, vector, right, out):
    """Fill `out` with what J times the vector of columns lacks of the right side."""
    for row in range(whole[ix.ROWS]):
        real[out + row] = real[right + row] - row_times(whole, real, vector, row)


@inner
def solve(whole, real, small, kept):
    """Fill the change with the least one, by mass, along which J changes by the right side, and its reactions.

    `small`: of a change that is itself a correction, so that a long chain's digits need none. `kept`: with the factor
    of the call before, for rows that have hardly turned since: one correction makes up for it.
    """
    rows, reaction, left, status = whole[ix.ROWS], whole[ix.REACTION], whole[ix.LEFT], whole[ix.STATUS]
    right, pivots, some = whole[ix.RIGHT], whole[ix.PIVOT], whole[ix.WHICH] != ALL
    soft_rows = whole[ix.SOFT] > 1 and not some
    pivot = real[status + ix.PIVOTED]
    if not kept or pivot < EASY:
        if soft_rows:
            assemble_soft(whole, real)
        else:
            assemble(whole, real)
        pivot = factorise(whole, real)
        real[status + ix.PIVOTED] = pivot
    real[status + ix.SMALLEST] = min(real[status + ix.SMALLEST], pivot)
    for row in range(rows):
        real[reaction + row] = 0.0 if some and left_out(whole, real, row) else real[right + row]
    substitute(whole, real, reaction)
    apply_reactions(whole, real)
    if (pivot > EASY and not kept and (small or rows <= FEW_ROWS)) or soft_rows:
        return  # reactions of soft rows miss the right side on purpose
    before = math.inf
    for _ in range(MOST_CORRECTIONS if pivot < EASY else 1):
        largest = 0.0
        residual(whole, real, whole[ix.CHANGE], right, left)
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
    rows, reaction, left = whole[ix.ROWS], whole[ix.REACTION], whole[ix.LEFT]
    assemble(whole, real)
    whole[ix.WHICH] = RIGID
    factorise(whole, real)
    for soft in range(rows):
        if left_out(whole, real, soft):
            for row in range(rows):
                real[reaction + row] = 1.0 if row == soft else 0.0
            apply_reactions(whole, real)
            felt = own = row_times(whole, real, whole[ix.CHANGE], soft)
            for row in range(rows):
                rigid = not left_out(whole, real, row)
                real[left + row] = row_times(whole, real, whole[ix.CHANGE], row) if rigid else 0.0
            substitute(whole, real, left)
            for row in range(rows):
                felt -= real[left + row] * row_times(whole, real, whole[ix.CHANGE], row)
            real[whole[ix.FELT] + soft] = max(felt, LEAST_FELT * own)
    whole[ix.WHICH] = ALL
    assemble(whole, real)
    for row in range(rows):
        record = whole[ix.ROW_AT] + ix.ROW * row
        diagonal = whole[ix.MATRIX] + whole[record + 4] + row - whole[record + 3]
        real[diagonal] += real[whole[ix.COMPLIANCE] + row] * real[whole[ix.FELT] + row]
