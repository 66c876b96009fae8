"""What the motion of a pymunk space runs into that its mechanism lacks: shapes that touch, limits that are reached."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from math import isinf
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import Constraint, GrooveJoint, RotaryLimitJoint, SlideJoint

from engines.pymunk.reading.joints import Described
from engines.reading import Obstacle, refuse

Array = NDArray[np.float64]
MOST_SHAPES = 400


def obstacles(
    space: pymunk.Space,
    bodies: Sequence[pymunk.Body],
    words: Sequence[str],
    labels: Sequence[str],
    t: Array,
    pose: Array,
) -> list[Obstacle]:
    """The first of each on poses (times, bodies, 3); `bodies` of the space by `words`, its constraints by `labels`.

    The space is used up: its bodies are moved. Raises Unsupported for too many shapes.
    """
    found: dict[str, Obstacle] = {}

    def meets(at: float, words: str, remedy: str) -> None:
        found.setdefault(words, Obstacle(float(at), words, remedy))

    shapes = [shape for shape in space.shapes if not shape.sensor]
    if len(shapes) > MOST_SHAPES:
        raise refuse("the space", f"it has {len(shapes)} shapes; more than {MOST_SHAPES} are not looked at")
    in_space = set(space.constraints)  # one that is outside keeps nothing apart, though its bodies name it
    pairs = [pair for pair in itertools.combinations(shapes, 2) if _may_touch(*pair, in_space)]
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
                meets(at, f"a shape of {who[0]} touches one of {who[1]}", "--without contact")
        for limit, label in limits:
            if _reached(limit):
                groove = isinstance(limit, GrooveJoint)
                meets(at, f"{label} reaches its end", "a longer groove" if groove else "--without limit")
    return sorted(found.values(), key=lambda each: each.t)


def sleepers(found: Described, step: float, t: Array, twist: Array) -> list[Obstacle]:
    """Bodies that pymunk may put to sleep on twists (times, bodies, 3): idle for as long as the space says.

    Idle, as Chipmunk counts (cpSpaceProcessComponents): m v^2 + I w^2 is at most m times the square of the threshold,
    or of what gravity adds to a speed in a step if there is none. Whether a body's neighbours idle too is not asked.
    """
    space = found.space
    if isinf(space.sleep_time_threshold):
        return []
    allowed = space.idle_speed_threshold or space.gravity.length * step
    out = []
    for place, (body, word) in enumerate(found.words.items()):
        if body.body_type != pymunk.Body.DYNAMIC:
            continue
        speed = np.hypot(twist[:, place, 0], twist[:, place, 1])
        turning = 0.0 if isinf(body.moment) else body.moment / body.mass * twist[:, place, 2] ** 2
        since = np.inf
        for at, idle in zip(t, speed**2 + turning <= allowed**2, strict=True):
            since = min(since, at) if idle else np.inf
            if at - since >= space.sleep_time_threshold:
                out.append(Obstacle(float(at), f"{word} may fall asleep", "--without sleep"))
                break
    return out


def _touch(one: pymunk.Shape, other: pymunk.Shape) -> bool:
    try:
        return bool(one.shapes_collide(other).points)
    except AssertionError:  # what pymunk itself calls likely a bug of its own: two shapes in exactly the same place
        return True


def _may_touch(one: pymunk.Shape, other: pymunk.Shape, in_space: set[Constraint]) -> bool:
    """Whether pymunk would let these shapes collide."""
    if one.body is other.body or one.body is None or other.body is None:
        return False
    if pymunk.Body.DYNAMIC not in (one.body.body_type, other.body.body_type):
        return False
    joined: Any = one.body.constraints & other.body.constraints & in_space
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
