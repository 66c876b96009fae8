"""Random models for `reports.search.raw`."""

from __future__ import annotations

import numpy as np

from reference.checks import InvalidMechanism
from reports.search.raw import Equality, Link, Model, coordinates
from reports.search.raw_law import judged

MOST_BODIES, MOST_EQUALITIES = 9, 3
HINGED = ("connect", "weld", "gear")


def model(seed: int, number: int, kinds: tuple[str, ...]) -> Model:
    """Case `number` of a seed with equalities of these kinds; the same on every machine.

    With connects, welds and gears alone every body is hinged, else some slide.
    """
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, number, len(kinds)])))
    while True:
        drawn = _drawn(random, kinds)
        if drawn.equalities and (any(drawn.gravity) or judged(drawn).rates.any()):
            return drawn


def _drawn(random: np.random.Generator, kinds: tuple[str, ...]) -> Model:
    def whole(low: int, high: int) -> int:
        return int(random.integers(low, high + 1))

    def two(most: int) -> tuple[int, int]:
        return whole(-most, most), whole(-most, most)

    count = whole(2, MOST_BODIES)
    hinged = {*kinds} <= {*HINGED}
    links = []
    for index in range(count):
        slides = 0 if hinged else (0, 0, 1, 2)[whole(0, 3)]
        links.append(
            Link(
                parent=whole(0, index) if whole(1, 4) == 1 else whole(min(1, index), index),  # few trees, which branch
                offset=two(8),
                angle=whole(-10, 10),
                slides=slides,
                turns=slides != 1 or whole(0, 1) == 1,
                centre=two(4),
                mass=whole(-3, 3),
                inertia=whole(-6, 0),
                velocity=(*two(4), whole(-6, 6)),
            )
        )
    moving = whole(1, 4) > 1
    if not moving:
        links = [Link(*(*vars(link).values(),)[:-1]) for link in links]
    out = Model(tuple(links), (), two(10), sparse=whole(0, 1) == 1)
    size = len(coordinates(out))
    for _ in range(whole(1, MOST_EQUALITIES)):
        kind = kinds[whole(0, len(kinds) - 1)]
        if kind in ("gear", "joint", "tendon"):
            slope, bend = two(4)
            new = Equality(kind, whole(0, size - 1), whole(0, size - 1), curve=(slope, 0 if kind == "gear" else bend))
        else:
            new = Equality(kind, whole(1, count), whole(0, count), two(6) if kind == "connect" else (0, 0))
        more = Model(out.links, (*out.equalities, new), out.gravity, out.sparse)
        try:
            judged(more)
        except InvalidMechanism:
            continue
        out = more
    return out
