"""Reactions of mechanisms with many joints: only joints that share a body meet, so the row system has a narrow band."""

from __future__ import annotations

from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dpbsv, dpbtrs  # pyright: ignore[reportAttributeAccessIssue] (missing in the stubs)
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from reference.joint_rows import JointRows

Array = NDArray[np.float64]

# From this many rows on a band is worth its bookkeeping; below it, the dense system is as fast.
MANY_ROWS = 24
# A pivot below this part of the largest, squared, counts as dependence: the same threshold as for ranks.
SMALLEST_PIVOT = 1e-9


def banded_reaction(joint_rows: JointRows, pose: Array, excess: Array, inertias: Array) -> Array:
    """Reactions (times, rows) [N, N m] at poses (times, bodies, 3); NaN where rows are dependent.

    `excess` (times, bodies, 3) are the accelerations without those of free fall, `inertias` (bodies, 3) the diagonal of
    the mass matrix M. J M^-1 J^T times the reactions is J excess: built from the joints' blocks, in an order that makes
    its band narrow, and factorised by Cholesky: O(bodies) for a chain, where the dense system costs O(bodies^3).
    """
    everything = joint_rows.with_ground(pose)
    times, count = len(pose), joint_rows.bodies
    mobility = np.concatenate([1 / inertias, np.zeros((1, 3))])  # the ground's, last, moves for no force
    excess = np.concatenate([excess, np.zeros((times, 1, 3))], axis=1)
    right = np.zeros((times, joint_rows.count))
    ends: dict[int, list[tuple[NDArray[np.intp], Array]]] = {}  # of each body, the rows on it and their blocks
    for group in joint_rows.groups:
        block = group.blocks(everything)
        for bodies, columns in ((group.first, slice(0, 3)), (group.second, slice(3, 6))):
            right[:, group.rows] += np.einsum("tjrc,tjc->tjr", block[..., columns], excess[:, bodies])
            for joint, body in enumerate(bodies.tolist()):
                if body < count:
                    ends.setdefault(body, []).append((group.rows[joint], block[:, joint, :, columns]))
    pairs: dict[tuple[int, int], Array] = {}
    for body, own in ends.items():
        for (rows, block), (others, other) in combinations_with_replacement(own, 2):
            product = np.einsum("trc,c,tsc->trs", block, mobility[body], other)
            same = rows is others or rows[0] == others[0]
            for i, row in enumerate(rows.tolist()):
                for j, column in enumerate(others.tolist()):
                    if same and block is other and column < row:
                        continue
                    key = (min(row, column), max(row, column))
                    pairs[key] = pairs.get(key, 0) + product[:, i, j]
    order, band = _narrow(joint_rows.count, list(pairs))
    place = np.argsort(order)
    matrix = np.zeros((times, band + 1, joint_rows.count))
    for (row, column), values in pairs.items():
        low, high = sorted((place[row], place[column]))
        matrix[:, high - low, low] = values  # LAPACK's lower band storage
    out = np.full_like(right, np.nan)
    factors: dict[int, Array] = {}
    for time in range(times):
        factor, solution, failed = dpbsv(matrix[time], right[time, order], lower=1)
        if not failed and factor[0].min() ** 2 > SMALLEST_PIVOT * factor[0].max() ** 2:
            out[time, order] = solution
            factors[time] = factor
    # Once more with what the forces leave of the accelerations: the product J M^-1 J^T has squared the condition of J,
    # and this gives the digits back (Bjorck 1987, corrected seminormal equations).
    missing = np.zeros_like(right)
    for body, own in ends.items():
        left = excess[:, body] - mobility[body] * sum(np.einsum("trc,tr->tc", b, out[:, rows]) for rows, b in own)
        for rows, block in own:
            missing[:, rows] += np.einsum("trc,tc->tr", block, left)
    for time, factor in factors.items():
        out[time, order] += dpbtrs(factor, missing[time, order], lower=1)[0]
    return out


def _narrow(rows: int, pairs: list[tuple[int, int]]) -> tuple[NDArray[np.intp], int]:
    """An order of the rows, and the width of the band that it leaves below the diagonal."""
    row, column = np.array(pairs).T
    graph = coo_array((np.ones(len(row)), (row, column)), shape=(rows, rows)).tocsr()
    order = reverse_cuthill_mckee((graph + graph.T).tocsr(), symmetric_mode=True).astype(np.intp)
    place = np.argsort(order)
    return order, int(np.abs(place[row] - place[column]).max())
