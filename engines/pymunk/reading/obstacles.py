"""What the motion of a pymunk space runs into that its mechanism lacks: shapes that touch, limits that are reached."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import GrooveJoint, RotaryLimitJoint, SlideJoint

from engines.reading import refuse

Array = NDArray[np.float64]
MOST_SHAPES = 400


def obstacles(
    space: pymunk.Space,
    bodies: Sequence[pymunk.Body],
    words: Sequence[str],
    labels: Sequence[str],
    t: Array,
    pose: Array,
) -> list[tuple[float, str]]:
    """When [s] and what, on poses (times, bodies, 3); `bodies` of the space by `words`, its constraints by `labels`.

    The space is used up: its bodies are moved. Raises Unsupported for too many shapes.
    """
    found: dict[str, float] = {}
    shapes = [shape for shape in space.shapes if not shape.sensor]
    if len(shapes) > MOST_SHAPES:
        raise refuse("the space", f"it has {len(shapes)} shapes; more than {MOST_SHAPES} are not looked at")
    pairs = [pair for pair in itertools.combinations(shapes, 2) if _may_touch(*pair)]
    limits = [
        (mine, label)
        for mine, label in zip(space.constraints, labels, strict=True)
        if isinstance(mine, SlideJoint | RotaryLimitJoint | GrooveJoint)
    ]
    names = {id(body): word for body, word in zip(bodies, words, strict=True)}
    for at, poses in zip(t, pose, strict=True):
        for body, (x, y, angle) in zip(bodies, poses, strict=True):
            body.angle = float(angle)
            body.position = pymunk.Vec2d(float(x), float(y)) - body.center_of_gravity.rotated(float(angle))
        for shape in shapes:
            shape.cache_bb()
        for one, other in pairs:
            if one.bb.intersects(other.bb) and _touch(one, other):
                who = [names.get(id(shape.body), "the ground") for shape in (one, other)]
                found.setdefault(f"a shape of {who[0]} touches one of {who[1]}", float(at))
        for limit, label in limits:
            if _reached(limit):
                found.setdefault(f"{label} reaches its end", float(at))
    return sorted((at, words) for words, at in found.items())


def _touch(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    try:
        return bool(one.shapes_collide(other).points)
    except AssertionError:  # what pymunk itself calls likely a bug of its own: two shapes in exactly the same place
        return True


def _may_touch(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    """Whether pymunk would let these shapes collide."""
    if one.body is other.body or one.body is None or other.body is None:
        return False
    if pymunk.Body.DYNAMIC not in (one.body.body_type, other.body.body_type):
        return False
    joined: Any = one.body.constraints & other.body.constraints
    if any(not joint.collide_bodies for joint in joined):
        return False
    mine, theirs = one.filter, other.filter
    if mine.group and mine.group == theirs.group:
        return False
    return bool(mine.categories & theirs.mask) and bool(theirs.categories & mine.mask)


def _reached(limit: Any) -> bool:
    """Whether a limit is at or beyond an end where its bodies are now."""
    a, b = limit.a, limit.b
    if isinstance(limit, SlideJoint):
        apart = a.local_to_world(limit.anchor_a).get_distance(b.local_to_world(limit.anchor_b))
        return not limit.min < apart < limit.max
    if isinstance(limit, RotaryLimitJoint):
        return not limit.min < b.angle - a.angle < limit.max
    begin, end = a.local_to_world(limit.groove_a), a.local_to_world(limit.groove_b)
    share = (b.local_to_world(limit.anchor_b) - begin).dot(end - begin) / (end - begin).dot(end - begin)
    return not 0 < share < 1
