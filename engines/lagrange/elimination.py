"""The order of the rows of a mechanism, and the entries of the matrix J M^-1 J^T.

The rows are in reverse Cuthill-McKee order, and the matrix is stored by paths in its elimination tree, with O(bodies)
entries for a tree of joints. Each entry is a sum of products of two ends of rows on one body. This module lists the
products of ends.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from engines.lagrange.records import PRODUCT_RECORD, Records


def cuthill_mckee(ends: Sequence[tuple[int, int]], ground: int) -> list[int]:
    """The joints in the order of Cuthill and McKee (1969), by the joints on their moving bodies.

    scipy's function gives the same order but for joints with equal degrees, and its import is slow.
    """
    on_body: dict[int, list[int]] = {}
    for joint, bodies in enumerate(ends):
        for body in {*bodies} - {ground}:
            on_body.setdefault(body, []).append(joint)
    # Neighbours begin with the last one of the second body, as in scipy's product of sparse matrices.
    neighbours = [
        list(dict.fromkeys(other for body in sorted({*bodies} - {ground}) for other in on_body[body]))[::-1]
        for bodies in ends
    ]
    degrees = [len(own) + (joint in own) for joint, own in enumerate(neighbours)]
    order, is_placed = list[int](), [False] * len(ends)
    # numpy's default sort is not stable with AVX-512, so the order of equal degrees would depend on the processor.
    for seed in sorted(range(len(degrees)), key=degrees.__getitem__):
        if is_placed[seed]:
            continue
        is_placed[seed], position = True, len(order)
        order.append(seed)
        while position < len(order):
            new = [joint for joint in neighbours[order[position]] if not is_placed[joint]]
            for joint in new:
                is_placed[joint] = True
            order += sorted(new, key=degrees.__getitem__)
            position += 1
    return order


def envelope(rows: Records, further_ends: Records, body_count: int) -> tuple[Records, NDArray[np.uintp]]:
    """Set the envelope; return the products of two ends on one body, and the later row of each entry.

    The parent of a row in the elimination tree is the first later row that its elimination changes. The entries of a
    row are the path in the tree from the row to the last row that its elimination changes (Liu 1990).
    """
    on_body: list[list[tuple[int, int]]] = [[] for _ in range(body_count + 1)]  # (row, end)
    for row, (first, second) in enumerate(zip(rows["first"].tolist(), rows["second"].tolist(), strict=True)):
        on_body[first].append((row, 2 * row))
        on_body[second].append((row, 2 * row + 1))
    for row, body, end in further_ends.tolist():
        on_body[body].append((row, end))
    moving = [sorted(ends) for ends in on_body[:-1]]
    paths = elimination_paths(len(rows), [[row for row, _ in ends] for ends in moving])
    rows["count"] = [len(path) for path in paths]
    rows["begin"] = np.cumsum(rows["count"]) - rows["count"]
    entries = [
        dict(zip(path, range(begin, begin + len(path)), strict=True))
        for begin, path in zip(rows["begin"].tolist(), paths, strict=True)
    ]
    products = [
        (entries[earlier][row], end, other, body)
        for body, ends in enumerate(moving)
        for k, (row, end) in enumerate(ends)
        for earlier, other in ends[: k + 1]
    ]
    columns = np.fromiter(itertools.chain.from_iterable(paths), np.uintp)
    return np.array(products, dtype=PRODUCT_RECORD), columns


def elimination_paths(row_count: int, coupled: Iterable[Sequence[int]]) -> list[list[int]]:
    """The path of each row. Each element of `coupled` has the ascending numbers of rows coupled with each other."""
    earlier: list[set[int]] = [set() for _ in range(row_count)]
    last = list(range(row_count))
    for group in coupled:
        for before, row in itertools.pairwise(group):
            earlier[row].add(before)  # the tree leads from the other rows of the group to `before`
        for row in group:
            last[row] = max(last[row], group[-1])
    parent, highest = list(range(row_count)), list(range(row_count))  # highest: a shortcut to the root of a subtree
    for row in range(row_count):
        for below in earlier[row]:
            while highest[below] not in (below, row):
                highest[below], below = row, highest[below]
            if highest[below] == below != row:
                parent[below] = highest[below] = row
    for row, above in enumerate(parent):
        last[above] = max(last[above], last[row])
    paths = []
    for row in range(row_count):
        path = [row]
        while path[-1] != last[row]:
            path.append(parent[path[-1]])
        paths.append(path)
    return paths
