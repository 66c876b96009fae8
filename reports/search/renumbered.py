"""Mechanisms of one shape: the same bodies hang together by the same joints and forces, and every number is another.

For engines that compile a program for each shape, which takes far longer than to ask it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np

from engines import Engine, Unsupported
from reference.checks import InvalidMechanism
from reports.search.mechanisms import recipe
from reports.search.parts import FORCES, Link, Part, Recipe
from reports.search.recipe import build

SHAPES = 6  # of a search, of each set of kinds; every second one with a loop
RUN = 10  # cases after which the next shape comes
MOST_TRIED = 400  # shapes that an engine may refuse

Whole = Callable[[int, int], int]


def of_a_shape(engine: Engine, seed: int, number: int, kinds: tuple[str, ...], decades: int) -> Recipe:
    """Case `number` of a seed: its shape is one of the first SHAPES of the seed that the engine builds, if it does."""
    shapes = _shapes(engine, seed, kinds, decades)
    if not shapes:
        return recipe(seed, number, kinds, decades)
    random = np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, number, decades, SHAPES])))
    return renumbered(shapes[number // RUN % len(shapes)], lambda low, high: int(random.integers(low, high + 1)))


@lru_cache(maxsize=8)
def _shapes(engine: Engine, seed: int, kinds: tuple[str, ...], decades: int) -> tuple[Recipe, ...]:
    found: list[Recipe] = []
    for number in range(MOST_TRIED):
        drawn = recipe(seed, number, kinds, decades)
        joints = [link for link in drawn.links if link.kind not in FORCES]
        if len(found) % 2 and len(joints) <= len(drawn.parts):
            continue
        mechanism = build(drawn)
        try:
            engine.build(mechanism, mechanism.time_scale)
        except Unsupported:
            continue
        found.append(drawn)
        if len(found) == SHAPES:
            break
    return tuple(found)


def renumbered(shape: Recipe, whole: Whole) -> Recipe:
    """The same shape with other numbers, in the ranges of `mechanisms`; `whole(low, high)` draws one, both included."""
    while True:
        moving = whole(1, 4) > 1
        pull = (whole(-10, 10), whole(-10, 10)) if not moving or whole(0, 1) else (0, 0)
        parts = tuple(_part(part, whole, moving) for part in shape.parts)
        drawn = replace(shape, parts=parts, links=tuple(_link(link, whole) for link in shape.links), gravity=pull)
        try:
            mechanism = build(drawn)
        except InvalidMechanism:  # rows that are nearly dependent
            continue
        if any(pull) or mechanism.twist.any():
            return drawn


def _part(part: Part, whole: Whole, moving: bool) -> Part:
    velocity = (whole(-4, 4), whole(-4, 4), whole(-6, 6)) if moving else (0, 0, 0)
    return replace(
        part,
        offset=(whole(-8, 8), whole(-8, 8)),
        angle=whole(-10, 10),
        size=part.size + whole(-1, 1),
        mass=part.mass + whole(-1, 1),
        gyration=whole(-3, 0),
        velocity=velocity,
    )


def _link(link: Link, whole: Whole) -> Link:
    """What is zero stays so: a drive at rest is held otherwise than one that turns. A ratio of gears is compiled in."""
    changed = replace(link, at=(whole(-6, 6), whole(-6, 6)))
    if link.turn:
        changed = replace(changed, turn=whole(-10, 10) or 1)
    if link.more and link.kind != "gear":
        changed = replace(changed, more=whole(1, 8) * (1 if whole(0, 1) else -1))
    if link.strength:
        changed = replace(changed, strength=whole(-2, 4) or 1)
    if link.rest:
        changed = replace(changed, rest=whole(-10, 10) or 1)
    return changed
