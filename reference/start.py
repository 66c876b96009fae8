"""What a mechanism's start has to satisfy: joints closed, nothing moving across them, springs with a direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from reference.validation import InvalidMechanism

if TYPE_CHECKING:
    from reference.mechanism import Mechanism

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
    gap = np.nan_to_num(np.abs(mechanism.gap(mechanism.pose, 0.0)))
    slip = np.abs(mechanism.slip(mechanism.pose, mechanism.twist))
    size = mechanism.length_scale
    place, turn = (float(np.abs(part).max()) for part in (mechanism.pose[:, :2], mechanism.pose[:, 2]))
    speed = float(np.abs(mechanism.twist[:, :2]).max()) + size * float(np.abs(mechanism.twist[:, 2]).max())
    # Relative to the mechanism's own size and speed, and above the rounding of a place far from the origin.
    far = ROUNDINGS * np.finfo(float).eps
    for value, (length, angle), (unit, angular), what in (
        (gap, (START_TOLERANCE * size + far * place, START_TOLERANCE + far * turn), ("m", "rad"), "open by"),
        (slip, (START_TOLERANCE * speed, START_TOLERANCE * speed / size), ("m/s", "rad/s"), "moving apart at"),
    ):
        allowed = np.where(mechanism.turning, angle, length)
        worst = int(np.argmax(value - allowed))
        if value[worst] > allowed[worst]:
            raise InvalidMechanism(
                f"mechanism: at t = 0 row {mechanism.row_names[worst]!r} is {what} {value[worst]:.3g} "
                f"{angular if mechanism.turning[worst] else unit}; the start must satisfy it to {allowed[worst]:.1g}"
            )
