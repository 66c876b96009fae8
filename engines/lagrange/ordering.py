"""In which order the rows of a row system J M^-1 J^T stand, and which products of ends of rows make its entries."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

Integers = NDArray[np.int64]
TERM = 4  # entry of the envelope; two ends of rows, and the body on which they meet: the entry gets their product


@lru_cache(maxsize=64)
def ordered(ends: bytes, size: bytes, bodies: int) -> tuple[Integers, ...]:
    """What `flat` takes from who is joined with whom alone: all mechanisms of one shape have it from here.

    Where the rows of joints begin; where each row stands, and its joint; and `_products`. The ends (joints, 2) and the
    sizes (joints,) are int64 as bytes, which can be remembered.
    """
    pairs, counts = np.frombuffer(ends, dtype=np.int64).reshape(-1, 2), np.frombuffer(size, dtype=np.int64)
    begin = _places(pairs, counts, bodies)
    place = np.array([row for at, count in zip(begin, counts, strict=True) for row in range(at, at + count)], dtype=int)
    owner = np.empty(len(place), dtype=np.int64)
    owner[place] = np.repeat(np.arange(len(pairs)), counts)
    return begin, place, owner, *_products(pairs[owner], bodies)


def _places(ends: Integers, size: Integers, bodies: int) -> Integers:
    """(joints,) where the first row of every joint stands, such that joints on one body are near each other."""
    count = len(ends)
    if not count:
        return np.zeros(0, dtype=np.int64)
    member, joint = ends.reshape(-1), np.repeat(np.arange(count), 2)
    moving = member < bodies
    on = coo_array((np.ones(moving.sum()), (joint[moving], member[moving])), shape=(count, bodies)).tocsr()
    order = reverse_cuthill_mckee((on @ on.T).tocsr(), symmetric_mode=True)
    begin = np.empty(count, dtype=np.int64)
    begin[order] = np.cumsum(size[order]) - size[order]
    return begin


def _products(bodies: Integers, count: int) -> tuple[Integers, Integers, Integers]:
    """Of rows between these bodies (rows, 2), `count` of which move: first columns, where rows begin, and TERMs."""
    ends: list[list[tuple[int, int]]] = [[] for _ in range(count)]
    for row, pair in enumerate(bodies.tolist()):
        for side, body in enumerate(pair):
            if body < count:
                ends[body].append((row, side))
    start = np.arange(len(bodies))
    for own in ends:
        for row, _ in own:
            start[row] = min(start[row], own[0][0])
    offset = np.append(0, np.cumsum(np.arange(len(bodies)) - start + 1))
    terms = [
        (offset[row] + column - start[row], 6 * row + 3 * side, 6 * column + 3 * other, 3 * body)
        for body, own in enumerate(ends)
        for i, (row, side) in enumerate(own)
        for column, other in own[: i + 1]
    ]
    return start, offset, np.array(terms, dtype=np.int64).reshape(-1, TERM)
