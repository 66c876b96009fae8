"""Poses that a motion is expected to pass: the number of sweeps is that of the worst of them.

They come from a pilot run of the engine with soft joints and long steps, whose errors do not matter here. Sixteen poses
are taken, since one costs as much as some hundred steps.
"""

from __future__ import annotations

import contextlib
from dataclasses import replace
from math import ceil

import numpy as np

from engines import Unsupported
from engines.pymunk.contraction import DENSE, contraction, contraction_at, contractions, steady
from engines.pymunk.joints.roll import SHIPPED_CONTACT
from engines.pymunk.model import Settings, build_model
from engines.pymunk.running import record
from engines.remembered import by_identity
from reference.checks import NonNegative, validated
from reference.joints import Roll
from reference.mechanism import Mechanism

POSES, FEW_POSES = 16, 2  # for up to DENSE rows, and beyond
ROUGH = 20  # steps in one radian of the fastest motion that is promised
MOST_STEPS = 4096
# Of a gap that is left after a step, with ten sweeps: no mechanism was found that explodes with it.
SOFT = Settings(
    iterations=10, error_bias=0.9, unit=1.0, skate="groove", roll="pivot", slot="exact", contact=SHIPPED_CONTACT
)
TORN = 0.05  # of the mechanism's length, or rad: from there on it is another mechanism


@validated
def worst_contraction(mechanism: Mechanism, duration: NonNegative, touching: bool = False) -> float:
    """The largest `contraction` over the start and what a rough run passes within `duration` [s], as it counts there.

    See `engines.pymunk.contraction.steady`; `touching`: whether a Roll is a contact.
    """
    return _worst(mechanism, float(f"{duration:.12g}"), touching)  # an extrapolation's levels round it differently


@by_identity()
def _worst(mechanism: Mechanism, duration: float, touching: bool) -> float:
    poses = _poses(mechanism, duration)
    rho = max([contraction(mechanism), *_all(mechanism, poses)])
    return steady(mechanism, np.array([mechanism.pose, *poses]), rho, touching)


def _all(mechanism: Mechanism, poses: list[np.ndarray]) -> list[float]:
    """The contraction at each pose, in one go where that is possible."""
    if poses and mechanism.row_count <= DENSE:
        with contextlib.suppress(np.linalg.LinAlgError):
            return contractions(mechanism, np.array(poses)).tolist()
    return [contraction_at(mechanism, pose) for pose in poses]


def _poses(mechanism: Mechanism, duration: float) -> list[np.ndarray]:
    if duration == 0 or not mechanism.joints:
        return []
    count = POSES if mechanism.row_count <= DENSE else FEW_POSES
    every = max(1, ceil(min(duration / mechanism.time_scale * ROUGH, MOST_STEPS) / count))
    dt = duration / (every * count)
    try:
        with np.errstate(all="ignore"):
            model = build_model(mechanism, replace(SOFT, unit=dt))
            poses = record(model, dt, count, every, raw=True).pose[1:]
            gap = mechanism.gap(poses, dt * every * np.arange(1, count + 1))
    except Unsupported:
        return []
    except (ValueError, ArithmeticError):
        # Curves may be led to where they have no contact; without any the mistake is ours.
        if not any(isinstance(joint, Roll) for joint in mechanism.joints):
            raise
        return []
    torn = np.abs(gap) > TORN * np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    sound = np.isfinite(poses).all(axis=(1, 2)) & ~torn.any(axis=1)
    return list(poses[sound])
