"""Joints as a page needs them: where they are, how far they are open, and what friction they demand."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from reference.joints import Joint, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.rolling.roll import Roll
from reports.site import drawn

Array = NDArray[np.float64]


def index_of(mechanism: Mechanism, name: str | None) -> int:
    """A body's place, -1 for the ground."""
    return -1 if name is None else mechanism.body_index(name)


def measure_of(mechanism: Mechanism) -> Literal["angle", "position"]:
    """Which error is told of a mechanism: that of places where it moves on skates, which hold none, else of angles."""
    return "position" if any(isinstance(joint, Skate) for joint in mechanism.joints) else "angle"


def joints_of(mechanism: Mechanism) -> list[dict[str, Any]]:
    """The pins and slots, whose gaps a page reads off poses: their bodies, points, and a slot's line."""
    return [
        {
            "name": joint.name,
            "first": index_of(mechanism, joint.first),
            "second": index_of(mechanism, joint.second),
            "firstPoint": list(joint.first_point),
            "secondPoint": list(joint.second_point),
            "line": joint.line_angle if isinstance(joint, Slot) else None,
        }
        for joint in mechanism.joints
        if isinstance(joint, Pin | Slot)
    ]


def between(mechanism: Mechanism, joint: Joint, pose: Array) -> tuple[Array, Array]:
    """The poses (times, 3) of both bodies of a joint, those of the ground are zero."""
    ground = np.zeros((len(pose), 3))
    names = (joint.first, joint.second)
    first, second = (ground if name is None else pose[:, mechanism.body_index(name)] for name in names)
    return first, second


def place_of(joint: Joint, first: Array, second: Array) -> Array:
    """Where a joint acts (times, 2) [m]: its point on the second body, or the contact of a Roll."""
    if isinstance(joint, Roll):
        return first[:, :2] + rotated(first[:, 2], joint.rolling.contact(second[:, 2] - first[:, 2]).point)
    return drawn.point_path(second, getattr(joint, "second_point", (0.0, 0.0)))


def opened(mechanism: Mechanism, joint: Skate | Roll, pose: Array, twist: Array) -> Array:
    """How a skate slips [m/s], or how far a Roll is from where it belongs [m], as vectors (times, 2) in the world."""
    first, second = between(mechanism, joint, pose)
    rows = joint.rows(first, second)
    if isinstance(joint, Roll):
        value = joint.gap(first, second, 0.0)
    else:
        speeds = [
            np.zeros((len(pose), 3)) if name is None else twist[:, mechanism.body_index(name)]
            for name in (joint.first, joint.second)
        ]
        value = np.einsum("tij,tj->ti", rows, np.concatenate(speeds, axis=-1))
    return np.einsum("ti,tij->tj", value, rows[..., 3:5])


def loose(mechanism: Mechanism) -> list[Skate | Roll]:
    """The joints whose opening can't be read off two points: skates, and rolling contacts."""
    return [joint for joint in mechanism.joints if isinstance(joint, Skate | Roll)]


def demanded(own: Array) -> Array:
    """The friction that rolling demands of its contact (times,) [1], from its reaction (times, 2) along and across.

    NaN where the normal force doesn't press: no friction is enough there.
    """
    with np.errstate(all="ignore"):
        return np.where(own[:, 1] > 0, np.abs(own[:, 0]) / own[:, 1], np.nan)
