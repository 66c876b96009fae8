"""Solve the row system J M^-1 J^T reaction = right (Schur complement of the KKT system), O(bodies) for a tree.

The factor L D L^T needs no scaling, since scaled rows give the same digits. If the ratio of a pivot to its diagonal
entry is below the limit, the row depends on earlier rows. Its reaction is set to zero, which does not change the
motion. The condition number of J M^-1 J^T is the square of that of J M^-1/2. If a pivot is small, the residual is
therefore computed with J, and the system is solved for a correction (corrected seminormal equations, Bjorck 1987).
"""

from __future__ import annotations

import math

from engines.lagrange.compiled import inlined, inner, merged, unsigned
from engines.lagrange.records import LEAST_INVERSE_INERTIA, RowLaw, RowSelection

# Largest pivot of a dependent row, relative to the diagonal, if all rows are independent at t = 0. The limit is a
# thousand times the rounding of the product.
INDEPENDENT_PIVOT = 1e-13
# Largest pivot of a dependent row if rows are dependent at t = 0, as RANK_TOLERANCE of `reference.rows`. The stages of
# a step have gaps, whose squares perturb the pivots.
DEPENDENT_PIVOT = 1e-9
# Smallest pivot that needs no correction, since rounding then costs less than two digits.
WELL_CONDITIONED = 1e-2
# A system with more rows is always corrected once, since the pivots of a long chain do not show the condition number.
FEW_ROWS = 24
# Largest number of corrections. Each correction must halve the residual, and four corrections are enough to reach
# rounding.
MOST_CORRECTIONS = 4


@inlined
def is_left_out(system, row):
    """Whether a row is not selected; the row then has the diagonal 1 and no coupling to other rows."""
    selection = system.status.selection
    if selection == RowSelection.HOLONOMIC:
        return system.rows[row].holonomic == 0
    return selection == RowSelection.RIGID and system.equations[row].compliance > 0


@inlined
def assemble(system):
    matrix, ends = system.matrix, system.ends
    for entry in range(len(matrix)):
        matrix[entry] = 0.0
    end, x, y, turn = unsigned(len(ends)), 0.0, 0.0, 0.0
    for index in range(len(system.products)):
        product = system.products[index]
        if product.end != end:  # products of the same end are consecutive
            end, body = product.end, system.bodies[product.body]
            row_end = ends[end]
            x, y = row_end.x * body.inverse_mass, row_end.y * body.inverse_mass
            turn = row_end.turn * body.inverse_inertia
        other = ends[product.other]
        matrix[product.entry] += x * other.x + y * other.y + turn * other.turn


@inlined
def factorise(system):
    """Replace the matrix by its factor; return the smallest pivot of independent rows relative to the diagonal.

    The elimination of a row changes the entries of the later rows on its path.
    """
    matrix, columns, inverse_pivots, rows = system.matrix, system.columns, system.inverse_pivots, system.rows
    limit = DEPENDENT_PIVOT if system.constants.dependent != 0 else INDEPENDENT_PIVOT
    smallest = 1.0
    if system.status.selection != RowSelection.ALL:
        leave_out(system)
    for row in range(len(rows)):
        inverse_pivots[unsigned(row)] = matrix[unsigned(rows[unsigned(row)].begin)]
    for row in range(len(rows)):
        begin, count = rows[unsigned(row)].begin, rows[unsigned(row)].count
        rest, diagonal = matrix[unsigned(begin)], inverse_pivots[unsigned(row)]
        if rest > limit * diagonal:
            smallest = min(smallest, rest / diagonal)
            inverse_pivot = 1.0 / rest
        else:
            inverse_pivot = 0.0 if rest <= limit * diagonal else math.nan
        inverse_pivots[unsigned(row)] = inverse_pivot
        for entry in range(begin + 1, begin + count):
            to = rows[columns[unsigned(entry)]].begin
            value = matrix[unsigned(entry)] * inverse_pivot
            for k in range(begin + count - entry):
                matrix[unsigned(to + k)] -= value * matrix[unsigned(entry + k)]
            matrix[unsigned(entry)] = value
    return smallest


@merged
def leave_out(system):
    """Remove the entries that couple selected rows with rows that are left out."""
    for row in range(len(system.rows)):
        is_out, begin = is_left_out(system, row), system.rows[row].begin
        if is_out:
            system.matrix[begin] = 1.0
        for entry in range(begin + 1, begin + system.rows[row].count):
            if is_out or is_left_out(system, system.columns[entry]):
                system.matrix[entry] = 0.0


@inlined
def substitute(system, vector):
    """Replace the vector (rows,) by the solution of L D L^T x = vector.

    A variable passes the result of a row to the next row, since memory access would take twice as long.
    """
    rows, matrix, columns, inverse_pivots = system.rows, system.matrix, system.columns, system.inverse_pivots
    last, value = len(rows) - 1, vector[unsigned(0)]
    for row in range(last):
        begin, end = rows[unsigned(row)].begin + 1, rows[unsigned(row)].begin + rows[unsigned(row)].count
        neighbour = vector[unsigned(row + 1)]
        vector[unsigned(row)] = value
        if begin < end and columns[unsigned(begin)] == unsigned(row + 1):
            neighbour -= matrix[unsigned(begin)] * value
            begin += 1
        for entry in range(begin, end):
            vector[columns[unsigned(entry)]] -= matrix[unsigned(entry)] * value
        value = neighbour
    vector[unsigned(last)] = value
    for row in range(len(rows)):
        vector[unsigned(row)] *= inverse_pivots[unsigned(row)]
    neighbour = vector[unsigned(last)]
    for row in range(last - 1, -1, -1):
        begin, value = rows[unsigned(row)].begin, vector[unsigned(row)]
        for entry in range(begin + rows[unsigned(row)].count - 1, begin + 1, -1):
            value -= matrix[unsigned(entry)] * vector[columns[unsigned(entry)]]
        if rows[unsigned(row)].count > 1:
            nearest = columns[unsigned(begin + 1)]
            value -= matrix[unsigned(begin + 1)] * (neighbour if nearest == unsigned(row + 1) else vector[nearest])
        vector[unsigned(row)] = neighbour = value


@inlined
def apply_reactions(system):
    change, ends, bodies = system.change, system.ends, system.bodies
    for k in range(len(change)):
        change[k] = 0.0
    for index in range(len(system.rows)):
        row = system.rows[index]
        add_end(change, row.first, ends[2 * index], system.reaction[index])
        add_end(change, row.second, ends[2 * index + 1], system.reaction[index])
    for index in range(len(system.further_ends)):
        end_record = system.further_ends[index]
        add_end(change, end_record.body, ends[end_record.end], system.reaction[end_record.row])
    for index in range(len(bodies)):
        body, at = bodies[index], 3 * index
        change[at] *= body.inverse_mass
        change[at + 1] *= body.inverse_mass
        change[at + 2] *= body.inverse_inertia


@inlined
def add_end(vector, body, end, factor):
    at = 3 * body
    vector[unsigned(at)] += end.x * factor
    vector[unsigned(at + 1)] += end.y * factor
    vector[unsigned(at + 2)] += end.turn * factor


@inlined
def row_times(system, index, vector):
    row, end, other = system.rows[index], system.ends[2 * index], system.ends[2 * index + 1]
    first, second = 3 * row.first, 3 * row.second
    value = (
        end.x * vector[unsigned(first)]
        + end.y * vector[unsigned(first + 1)]
        + end.turn * vector[unsigned(first + 2)]
        + other.x * vector[unsigned(second)]
        + other.y * vector[unsigned(second + 1)]
        + other.turn * vector[unsigned(second + 2)]
    )
    for k in range(len(system.further_ends)):
        end_record = system.further_ends[k]
        if end_record.row == index:
            end, at = system.ends[end_record.end], 3 * end_record.body
            value += (
                end.x * vector[unsigned(at)] + end.y * vector[unsigned(at + 1)] + end.turn * vector[unsigned(at + 2)]
            )
    return value


@inner
def factorise_rows(system):
    if system.constants.regularised == RowLaw.COMPLIANT and system.status.selection == RowSelection.ALL:
        assemble_compliant(system)
    else:
        assemble(system)
    system.status.factor_pivot = factorise(system)


@inner
def solve(system, corrections):
    """Set `change` to the least solution of J change = right in the norm of the masses, and set the reactions.

    corrections: number of corrections if all pivots are large; otherwise there are up to MOST_CORRECTIONS.
    """
    rows, status = len(system.rows), system.status
    reaction, residual, right = system.reaction, system.residual, system.right
    is_part, pivot = status.selection != RowSelection.ALL, status.factor_pivot
    status.smallest_pivot = min(status.smallest_pivot, pivot)
    for row in range(rows):
        reaction[row] = 0.0 if is_part and is_left_out(system, row) else right[row]
    substitute(system, reaction)
    apply_reactions(system)
    if system.constants.regularised == RowLaw.COMPLIANT and not is_part:
        return  # J change need not be equal to the right side
    last_largest = math.inf
    for _ in range(corrections if pivot > WELL_CONDITIONED else MOST_CORRECTIONS):
        largest = 0.0
        for row in range(rows):
            missing = (
                0.0 if is_part and is_left_out(system, row) else right[row] - row_times(system, row, system.change)
            )
            residual[row] = missing
            largest = max(largest, missing * missing * system.inverse_pivots[row])
        if not 0 < largest < 0.25 * last_largest:
            return
        last_largest = largest
        substitute(system, residual)
        for row in range(rows):
            reaction[row] += residual[row]
        apply_reactions(system)


@inner
def assemble_compliant(system):
    """Set the matrix to J M^-1 J^T plus compliances, in units of the rows' inverse inertias, on the diagonal.

    The unit is the inverse inertia under the constraints of the rigid rows (the diagonal of the Schur complement). The
    unit is at least LEAST_INVERSE_INERTIA times the inverse inertia of the row alone.
    """
    reaction, residual, equations = system.reaction, system.residual, system.equations
    rows = len(system.rows)
    assemble(system)
    system.status.selection = RowSelection.RIGID
    factorise(system)
    for compliant in range(rows):
        if is_left_out(system, compliant):
            for row in range(rows):
                reaction[row] = 1.0 if row == compliant else 0.0
            apply_reactions(system)
            inverse_inertia = alone = row_times(system, compliant, system.change)
            for row in range(rows):
                residual[row] = 0.0 if is_left_out(system, row) else row_times(system, row, system.change)
            substitute(system, residual)
            for row in range(rows):
                inverse_inertia -= residual[row] * row_times(system, row, system.change)
            equations[compliant].inverse_inertia = max(inverse_inertia, LEAST_INVERSE_INERTIA * alone)
    system.status.selection = RowSelection.ALL
    assemble(system)
    for row in range(rows):
        equation = equations[row]
        system.matrix[system.rows[row].begin] += equation.compliance * equation.inverse_inertia
