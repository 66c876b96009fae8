"""Box2D's velocities after its first step of one sub-step, against the law of its soft joints, in single precision.

In a sub-step joints correct velocities twice: softly, with the rows of the start, and after the drift for good, with
the rows of the new pose. The soft correction takes a share of what a rigid one would, which the engine declares. One
sweep is the solution only where every moving body has one joint; others are not asked for. Rows that the engine solves
together are one block: all of a joint's, but of a weld's the angle comes first and the point after it. That angle is
the engine's own b2Atan2 of two rotations, a polynomial that misses up to 2.8e-5 rad: a weld stands off by as much, and
is pushed back at the start.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines.box2d import Box2D
from reference.joints import Pin, Rod, Slot, Weld
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.law import ROUNDINGS, Fault, NotAsked, difference, lost_in_products, written

Array = NDArray[np.float64]
STEP = 0.1  # of the mechanism's own time scale: what forces change in it has to be seen beside rounded velocities
SEEN = 2.0**-26  # of a number: small beside what a formula bends in it, large beside rounding in double precision


def bound(engine: Box2D) -> float:
    """The error, relative to the largest velocity, above which something is wrong."""
    return ROUNDINGS * engine.precision


def errors(engine: Box2D, mechanism: Mechanism) -> dict[str, float]:
    """By what velocities miss the law after the first step, relative to the largest.

    Raises NotAsked where one sweep over the joints is no solution, and Unsupported.
    """
    told, law, others = first_step(engine, mechanism)
    return {"velocity": difference(mechanism, told.twist[1], law, others)}


def first_step(engine: Box2D, mechanism: Mechanism) -> tuple[Trajectory, Array, tuple[Array, ...]]:
    """The first step, velocities (bodies, 3) that its joints declare after it, and sizes that errors are beside."""
    if engine.closing:
        raise NotAsked("joints held by a weld joint's own frequencies are solved row by row")
    _refuse_chains(mechanism)
    dt = STEP * mechanism.time_scale
    told = replace(engine, substeps=1).build(mechanism, dt)(1, 1)
    poses = [pose for pose in told.pose if np.isfinite(pose).all()]
    lost = max(lost_in_products(mechanism, pose) for pose in poses) * engine.precision / np.finfo(float).eps
    if ROUNDINGS * lost >= 1:
        raise NotAsked("in single precision nothing is left of J M^-1 J^T of a joint")
    if not np.isfinite(told.pose).all():
        raise Fault("it was lost within a step")
    if told.warnings:
        raise NotAsked("it says itself that something is wrong")
    free = mechanism.twist + dt * mechanism.unconstrained(mechanism.pose, mechanism.twist)
    states = np.array([*told.pose, mechanism.twist, np.zeros_like(free), np.zeros_like(free)])
    between, law = _law(mechanism, dt, states)
    return told, law, (free, mechanism.twist, _rounded(engine, mechanism, dt, states, (free, between, law)) / ROUNDINGS)


def _law(mechanism: Mechanism, dt: float, states: Array, off: Array | None = None) -> Array:
    """Velocities (2, bodies, 3) after each of both corrections, from states (5, bodies, 3).

    They are the poses of the start and after the drift, the start's twist, and what is added to twists before each.
    `off` (2, rows, 3) are the parts by which numbers of each correction are off: see `_impulse`.
    """
    start, drifted, twist, kicked, added = states
    free = twist + dt * mechanism.unconstrained(start, twist) + kicked
    before, after = mechanism.rows(start), mechanism.rows(drifted)
    # How heavy a joint's rows are, the engine works out at the start; of a point's, solved together, in each pass anew.
    points = np.array([isinstance(joint, Pin | Weld) for joint in mechanism.joints for _ in range(joint.size)], bool)
    share, rate = _share(dt)
    first, second = np.zeros((2, len(points), 3)) if off is None else off
    gap = _gap(mechanism, first[:, 0]) + before @ (start - mechanism.pose).reshape(-1)
    weighed = np.where(points[:, None], after, before)
    soft = _swept(mechanism, before, before, free, share, mechanism.rate - rate * gap, first) + added
    return np.array([soft, _swept(mechanism, after, weighed, soft, 1.0, mechanism.rate, second)])


def _rounded(engine: Box2D, mechanism: Mechanism, dt: float, states: Array, twists: tuple[Array, ...]) -> Array:
    """What numbers that are off by a unit of themselves change of the law (bodies, 3), as parts of that unit.

    Rounded are the places, cosines and velocities that bodies are stored in, before and after each correction, of which
    the `twists` are the largest, and what an impulse is worked out from. The law itself says what becomes of each: a
    force element pushes otherwise; a place that is off is a gap, which the first correction closes at its own rate, and
    the second, which knows no gap, takes back but for what rows have turned meanwhile; an arm or a line that is off by
    it lets a velocity slip; a determinant that is off scales an impulse. So it is evaluated again with each number off
    by SEEN of itself. Rounding has no sign, so squares are added. A light body far from the origin is pushed so fast
    to close the gap of rounded places, and back, that rounding of this, too, is seen.
    """
    far = written(mechanism, float(np.abs(states[:2, :, :2]).max()))
    size = np.array([1.0, 1.0, mechanism.length_scale])
    apart = np.where(np.arange(len(far)) % 2, 1.0, -1.0)[:, None] * [1.0, 1.0, 0.0]
    between, _ = _law(mechanism, dt, np.array([states[0] + engine.precision * far * apart, *states[1:]]))
    speeds = [np.abs(twist * size).max(axis=1, keepdims=True) for twist in (*twists, states[2], between)]
    fast, right = np.max(speeds, axis=0) / size, twists[-1]
    numbers, changed = np.array([far, far, fast, fast, fast]), np.zeros_like(right)
    for place in np.ndindex(states.shape):
        moved = states.copy()
        moved[place] += SEEN * numbers[place]
        changed += ((_law(mechanism, dt, moved)[1] - right) / SEEN) ** 2
    for place in np.ndindex(2, mechanism.row_count, 3):
        off = np.zeros((2, mechanism.row_count, 3))
        off[place] = SEEN
        changed += ((_law(mechanism, dt, states, off)[1] - right) / SEEN) ** 2
    return np.sqrt(changed)


def _swept(
    mechanism: Mechanism, rows: Array, weighed: Array, twist: Array, share: float, wanted: Array, off: Array
) -> Array:
    """A twist (bodies, 3) after this share of what gives rows (rows, 3 bodies) the `wanted` rates (rows,).

    How heavy a row is, is taken from the rows `weighed`; `off` (rows, 3) as in `_impulse`.
    """
    light, twist = 1 / mechanism.inertias.reshape(-1), twist.reshape(-1)
    heavy, terms = (weighed * light) @ weighed.T, (np.abs(weighed) * light) @ np.abs(weighed.T)
    for block in _blocks(mechanism):
        among, missed = np.ix_(block, block), wanted[block] - rows[block] @ twist
        impulse = _impulse(heavy[among], terms[among], missed, off[block])
        twist = twist + share * light * (impulse @ rows[block])
    return twist.reshape(-1, 3)


def _blocks(mechanism: Mechanism) -> Iterator[list[int]]:
    """The rows that the engine solves together, in its order."""
    begin = 0
    for joint in mechanism.joints:
        rows = [*range(begin, begin := begin + joint.size)]
        if isinstance(joint, Weld):
            yield [rows.pop()]
        yield rows


def _impulse(heavy: Array, terms: Array, missed: Array, off: Array) -> Array:
    """The impulse (n,) that gives one row, or the two of a point, the velocity (n,) that is missed.

    Two are solved by Cramer's rule (b2Solve22 in the engine's math_functions.h) for `heavy`, K = J M^-1 J^T (2, 2), the
    sum of `terms`. Where a light body's centre is far from the point, the determinant and both numerators are small
    differences of large products. What rounding of them leaves is no solution of any K nearby (Higham 2002, section
    1.10.1), so they are `off` (2, 3) by themselves: by column, both entries of K's diagonal; its other entry and the
    determinant; and the numerators; all by parts of the products' sizes.
    """
    if len(missed) == 1:
        return missed / heavy[0]
    (first, second), (mixed, whole), numerators = off.T
    a, b, c = heavy[0, 0] + first * terms[0, 0], heavy[0, 1] + mixed * terms[0, 1], heavy[1, 1] + second * terms[1, 1]
    numerator = np.array([c * missed[0] - b * missed[1], a * missed[1] - b * missed[0]])
    sizes = np.array([abs(c * missed[0]) + abs(b * missed[1]), abs(a * missed[1]) + abs(b * missed[0])])
    return (numerator + numerators * sizes) / (a * c - b * b + whole * a * c)


def _share(step: float) -> tuple[float, float]:
    """Of a rigid correction, in the first of the two, and the rate [1/s] at which a gap is closed then.

    b2MakeSoft in the engine's solver.h, with a damping ratio of 2. The frequency is 60 Hz, or a quarter of the rate of
    sub-steps where that is less.
    """
    frequency = 2 * math.pi * min(60.0, 0.25 / step)
    turn = frequency * step
    return turn * (4.0 + turn) / (1 + turn * (4.0 + turn)), frequency / (4.0 + turn)


def _gap(mechanism: Mechanism, off: Array) -> Array:
    """What it takes for gaps (rows,) at the start: those of angles of welds, which it reads `off` (rows,) by parts."""
    angles = {None: 0.0} | {body.name: body.pose[2] for body in mechanism.bodies}
    welded = [
        angles[joint.second] - angles[joint.first] if isinstance(joint, Weld) and label == "torque" else 0.0
        for joint in mechanism.joints
        for label in joint.labels
    ]
    return np.array([_misread(angle) + part * _wrapped(angle) for angle, part in zip(welded, off, strict=True)])


def _misread(angle: float) -> float:
    """By how much b2Atan2 of the engine's math_functions.h is above an angle [rad], between half a turn either way."""
    x, y = abs(math.cos(angle)), abs(math.sin(angle))
    tangent = min(x, y) / max(x, y)
    square = tangent * tangent
    odd, even = 0.024840285 * square**2 + 0.18681418, -0.094097948 * square**2 - 0.33213072
    found = (odd * square + even) * square * tangent + tangent
    found = math.pi / 2 - found if y > x else found
    found = math.pi - found if math.cos(angle) < 0 else found
    return math.copysign(found, math.sin(angle)) - _wrapped(angle)


def _wrapped(angle: float) -> float:
    return math.remainder(angle, 2 * math.pi)


def _refuse_chains(mechanism: Mechanism) -> None:
    """Raises NotAsked where a body has two joints, or a joint is of a kind that the law does not know."""
    ends = [name for joint in mechanism.joints for name in (joint.first, joint.second) if name is not None]
    if len(ends) != len({*ends}):
        raise NotAsked("one sweep over joints that share a body is no solution, and the engine makes no more")
    if not all(isinstance(joint, Pin | Slot | Rod | Weld) for joint in mechanism.joints):
        raise NotAsked("a joint whose rows are solved one after the other is not solved by one sweep")
