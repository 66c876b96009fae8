"""Box2D's velocities after its first step of one sub-step, against the law of its soft joints, in single precision.

In a sub-step joints correct velocities twice: softly, with the rows of the start, and after the drift for good, with
the rows of the new pose. The soft correction takes a share of what a rigid one would, which the engine declares. One
sweep is the solution only where every moving body has one joint of one block of rows; others are not asked for.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines.box2d import Box2D
from reference.joints import Pin, Rod, Slot
from reference.mechanism import Mechanism
from reports.search.law import Fault, NotAsked, difference

Array = NDArray[np.float64]
STEP = 0.1  # of the mechanism's own time scale: what forces change in it has to be seen beside rounded velocities
ROUNDINGS = 100.0  # of the engine's numbers, which the rows of a pose and some sums leave


def bound(engine: Box2D) -> float:
    """The error, relative to the largest velocity, above which something is wrong."""
    return ROUNDINGS * engine.precision


def errors(engine: Box2D, mechanism: Mechanism) -> dict[str, float]:
    """By what velocities miss the law after the first step, relative to the largest.

    Raises NotAsked where one sweep over the joints is no solution, and Unsupported.
    """
    if engine.closing:
        raise NotAsked("joints held by a weld joint's own frequencies are solved row by row")
    _refuse_chains(mechanism)
    dt = STEP * mechanism.time_scale
    told = replace(engine, substeps=1).build(mechanism, dt)(1, 1)
    if not np.isfinite(told.pose).all():
        raise Fault("it was lost within a step")
    start = mechanism.pose
    free = mechanism.twist + dt * mechanism.unconstrained(start, mechanism.twist)
    before, after = mechanism.rows(start), mechanism.rows(told.pose[1])
    # How heavy a joint's rows are, the engine works out at the start; of a pin's, whose two are solved together, anew.
    pinned = np.array([isinstance(joint, Pin) for joint in mechanism.joints for _ in range(joint.size)], dtype=bool)
    soft = free + _share(dt) * _correction(mechanism, before, before, free)
    law = soft + _correction(mechanism, after, np.where(pinned[:, None], after, before), soft)
    # A place is rounded, and over a step that is a velocity.
    far = max(mechanism.length_scale, float(np.abs(told.pose[..., :2]).max()))
    others = (free, mechanism.twist, np.array([[engine.precision * far / dt / bound(engine), 0.0, 0.0]]))
    return {"velocity": difference(mechanism, told.twist[1], law, others)}


def _correction(mechanism: Mechanism, rows: Array, weighed: Array, twist: Array) -> Array:
    """The change (bodies, 3) that stops what a twist does to rows (rows, 3 bodies), weighed as others are."""
    if not len(rows):
        return np.zeros_like(twist)
    light = 1 / mechanism.inertias.reshape(-1)
    impulse = np.linalg.solve((weighed * light) @ weighed.T, mechanism.rate - rows @ twist.reshape(-1))
    return (light * (rows.T @ impulse)).reshape(-1, 3)


def _share(step: float) -> float:
    """Of a rigid correction, in the first of the two: b2MakeSoft in the engine's solver.h, with a damping ratio of 2.

    The frequency is 60 Hz, or a quarter of the rate of sub-steps where that is less.
    """
    turn = 2 * math.pi * min(60.0, 0.25 / step) * step
    return turn * (4.0 + turn) / (1 + turn * (4.0 + turn))


def _refuse_chains(mechanism: Mechanism) -> None:
    """Raises NotAsked where a body has two joints, or a joint more than one block of rows."""
    ends = [name for joint in mechanism.joints for name in (joint.first, joint.second) if name is not None]
    if len(ends) != len({*ends}):
        raise NotAsked("one sweep over joints that share a body is no solution, and the engine makes no more")
    if not all(isinstance(joint, Pin | Slot | Rod) for joint in mechanism.joints):
        raise NotAsked("a joint whose rows are solved one after the other is not solved by one sweep")
