"""What a mechanism's start has to satisfy: joints closed, nothing moving across them, springs with a direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism

if TYPE_CHECKING:
    from reference.mechanism import Mechanism

Array = NDArray[np.float64]
# A start that misses a row by more than this fraction of the mechanism's own length or speed is refused: far above
# rounding, far below a mistake.
START_TOLERANCE = 1e-9
ROUNDINGS = 64  # of a coordinate: what placing a body and its joints may take


def refuse_a_bad_start(mechanism: Mechanism) -> None:
    """Raise InvalidMechanism for a start that no engine could begin with, in a sentence that names the row or force."""
    _refuse_open_joints(mechanism)
    for element in mechanism.forces:
        still = np.zeros(3)
        first, second = (
            still if name is None else mechanism.pose[mechanism.body_index(name)]
            for name in (element.first, element.second)
        )
        if not np.isfinite(element.on(first, second, still, still)).all():
            raise InvalidMechanism(
                f"force {element.name!r}: at t = 0 its two points coincide, so it has no direction; move one of them"
            )


def _refuse_open_joints(mechanism: Mechanism) -> None:
    if not mechanism.joints:
        return
    gap, slip = mechanism.gap(mechanism.pose, 0.0), mechanism.slip(mechanism.pose, mechanism.twist)
    size = np.asarray(mechanism.length_scale)
    sentence = open_joint(mechanism, gap, slip, mechanism.pose, mechanism.twist, size)
    if sentence is not None:
        raise InvalidMechanism(f"mechanism: {sentence}")


def open_joint(
    mechanism: Mechanism, gap: Array, slip: Array, pose: Array, twist: Array, size: Array, begin: int = 0
) -> str | None:
    """What is wrong with the start of one mechanism, or of the worst of many of its shape; None if nothing is.

    gap, slip (..., rows); pose, twist (..., bodies, 3); size (...) [m], of many in one line; `begin`: the number of the
    first of many.
    """
    place, turn = np.abs(pose[..., :2]).max(axis=(-2, -1)), np.abs(pose[..., 2]).max(axis=-1)
    speed = np.abs(twist[..., :2]).max(axis=(-2, -1)) + size * np.abs(twist[..., 2]).max(axis=-1)
    # Relative to the mechanism's own size and speed, and above the rounding of a place far from the origin.
    far = ROUNDINGS * np.finfo(float).eps
    for missed, (length, angle), (unit, angular), what in (
        (gap, (START_TOLERANCE * size + far * place, START_TOLERANCE + far * turn), ("m", "rad"), "open by"),
        (slip, (START_TOLERANCE * speed, START_TOLERANCE * speed / size), ("m/s", "rad/s"), "moving apart at"),
    ):
        value = np.nan_to_num(np.abs(missed))
        allowed = np.where(mechanism.turning, angle[..., None], length[..., None])
        worst = np.unravel_index(np.argmax(value - allowed), value.shape)
        if value[worst] > allowed[worst]:
            row, which = worst[-1], "".join(f" of mechanism {begin + number}" for number in worst[:-1])
            return (
                f"at t = 0 row {mechanism.row_names[row]!r}{which} is {what} {value[worst]:.3g} "
                f"{angular if mechanism.turning[row] else unit}; the start must satisfy it to {allowed[worst]:.1g}"
            )
    return None
