"""What is drawn of a mechanism, as numbers: a bar through the joint points of each body, and points on the ground."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.joints import Slot
from reference.mechanism import Mechanism
from reference.plane import rotated

Array = NDArray[np.float64]


def body_points(mechanism: Mechanism, pose: Array) -> dict[str, Array]:
    """World points (points, 2) [m] of each body's joints, in the order of the joints, for one pose (bodies, 3)."""
    own: dict[str, list[tuple[float, float]]] = {body.name: [] for body in mechanism.bodies}
    for joint in mechanism.joints:
        for name, attribute in ((joint.first, "first_point"), (joint.second, "second_point")):
            point = getattr(joint, attribute, None)
            if name is not None and point is not None and point not in own[name]:
                own[name].append(point)
    out = {}
    for name, points in own.items():
        x, y, angle = pose[mechanism.body_index(name)]
        out[name] = np.array([x, y]) + rotated(angle, np.array(points, dtype=float).reshape(-1, 2))
    return out


def ground_points(mechanism: Mechanism) -> Array:
    """World points (points, 2) [m] at which joints hold to the ground; a slot holds to a line, which has none."""
    points = [
        getattr(joint, attribute)
        for joint in mechanism.joints
        for name, attribute in ((joint.first, "first_point"), (joint.second, "second_point"))
        if name is None and hasattr(joint, attribute) and not isinstance(joint, Slot)
    ]
    return np.array(list(dict.fromkeys(points)), dtype=float).reshape(-1, 2)
