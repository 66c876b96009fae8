"""What MuJoCo does not say of a run with rolling in it: a contact was lost, or was too fast to follow."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

Array = NDArray[np.float64]

# Of the largest reaction: a contact that is absent leaves nothing but rounding.
NOTHING = 1e-9
# The turn of the curves [rad] under the contact in one step, beyond which no method of order 4 is worth its name.
FAST = 0.1


def roll_warnings(mechanism: Mechanism, step: float, t: Array, pose: Array, twist: Array, reaction: Array) -> list[str]:
    """Sentences that begin with "ours:", for the samples (times,) of a run with this step [s].

    Nearly conformal curves: the contact runs along them by omega / (curvature_A + curvature_B), so that it turns by
    omega dt / conformality in a step, which must stay small whatever the body itself turns by.
    """
    found: list[str] = []
    if not len(t):
        return found
    first_row = 0
    for joint in mechanism.joints:
        if isinstance(joint, Roll):
            rows = reaction[:, first_row : first_row + joint.size]
            found += _lost(joint, t, rows)
            found += _fast(joint, mechanism, step, t, pose, twist)
        first_row += joint.size
    return found


def _lost(joint: Roll, t: Array, rows: Array) -> list[str]:
    size = np.abs(rows).max(axis=1)
    absent = size <= NOTHING * size.max()
    if size.max() > 0 and not absent.any():
        return []
    share = np.count_nonzero(absent) / len(t)
    when = t[int(np.argmax(absent))]
    return [
        f"ours: the contact {joint.name!r} was lost: it carries nothing in {share:.2g} of the samples, "
        f"first at {when:.4g} s"
    ]


def _fast(joint: Roll, mechanism: Mechanism, step: float, t: Array, pose: Array, twist: Array) -> list[str]:
    def of(states: Array, name: str | None) -> Array:
        return np.zeros(len(t)) if name is None else states[:, mechanism.body_index(name), 2]

    angle = of(pose, joint.second) - of(pose, joint.first)
    rate = np.abs(of(twist, joint.second) - of(twist, joint.first))
    turned = rate * step / joint.rolling.contact(angle).conformality
    worst = int(np.argmax(turned))
    if not turned[worst] > FAST:
        return []
    return [
        f"ours: at {t[worst]:.4g} s the contact {joint.name!r} turns by {turned[worst]:.2g} rad along its curves in "
        f"one step; a step of {step * FAST / turned[worst]:.2g} s would follow it"
    ]
