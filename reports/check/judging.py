"""The judge's motion of a mechanism, what the judge itself may be wrong by, and how long it can be trusted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from engines.lagrange import TRUTH
from engines.lagrange.dynamics import Dynamics
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
LOOSER = replace(TRUTH, tolerance=1e-10)  # the judge at another tolerance: its own error is what that changes
NUDGE = 1e-7  # of the length, and of the speed: small enough to be a derivative, far above the judge's error
SEEDS = (1, 2)
# A disturbance of a motion that is not chaotic grows about as the time; this many times that is taken as exponential.
GROWN = 100.0


@dataclass(frozen=True, eq=False)
class Judged:
    """The ideal motion, and the same at a `looser` tolerance: the difference tells what the judge may be wrong by."""

    trajectory: Trajectory
    looser: Trajectory
    growth: Array  # (times,) how many times a small disturbance of the start has grown
    horizon: float  # s; the duration if errors grow no faster than about linearly


def judged(mechanism: Mechanism, samples: int, spacing: float) -> Judged:
    """The motion of ideal joints. Raises InvalidMechanism where it can't be followed to the end."""
    motion = TRUTH.build(mechanism, spacing)(samples, 1)
    sound = np.isfinite(motion.pose).all(axis=(1, 2))
    if not sound.all():
        raise InvalidMechanism(
            f"the ideal motion can't be followed beyond {motion.t[int(np.argmin(sound))]:.4g} s: the joints are in a "
            f"singular position or the forces grow without bound; give a shorter --duration"
        )
    looser = LOOSER.build(mechanism, spacing)(samples, 1)
    growth = np.max([_growth(mechanism, motion, samples, spacing, seed) for seed in SEEDS], axis=0)
    expected = GROWN * (1 + motion.t / mechanism.time_scale)
    beyond = growth > expected
    horizon = float(motion.t[int(np.argmax(beyond))] if beyond.any() else motion.t[-1])
    return Judged(motion, looser, growth, horizon)


def apart(mechanism: Mechanism, pose: Array, other: Array) -> Array:
    """How far poses (times, bodies, 3) are from others (times,): the larger of angles [rad] and places in lengths."""
    difference = np.abs(pose - other)
    places = np.hypot(difference[..., 0], difference[..., 1]) / mechanism.length_scale
    return np.maximum(places, difference[..., 2]).max(axis=1)


def often(motion: Trajectory, parts: int) -> tuple[Array, Array, Array]:
    """Times, poses and twists of a motion `parts` times as often as it was sampled, by cubics through both."""
    spline = CubicHermiteSpline(motion.t, motion.pose, motion.twist)
    t = np.linspace(motion.t[0], motion.t[-1], parts * (len(motion.t) - 1) + 1)
    return t, spline(t), spline(t, 1)


def _growth(mechanism: Mechanism, motion: Trajectory, samples: int, spacing: float, seed: int) -> Array:
    dynamics, random = Dynamics(mechanism, 0.0), np.random.default_rng(seed)
    unit = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
    pose = mechanism.pose + NUDGE * unit * random.uniform(-1, 1, mechanism.pose.shape)
    twist = mechanism.twist + NUDGE / mechanism.time_scale * unit * random.uniform(-1, 1, mechanism.twist.shape)
    pose, twist = dynamics.project(pose, twist, 0.0)
    if not (np.isfinite(pose).all() and np.isfinite(twist).all()):
        return np.ones(samples + 1)
    bodies = tuple(
        replace(body, pose=tuple(map(float, own)), twist=tuple(map(float, rate)))
        for body, own, rate in zip(mechanism.bodies, pose, twist, strict=True)
    )
    try:
        disturbed = TRUTH.build(replace(mechanism, bodies=bodies), spacing)(samples, 1)
    except InvalidMechanism:  # a position in which nothing small is allowed
        return np.ones(samples + 1)
    size = np.hypot(
        _size(disturbed.pose - motion.pose, unit), mechanism.time_scale * _size(disturbed.twist - motion.twist, unit)
    )
    return np.nan_to_num(size, nan=np.inf) / size[0] if size[0] > 0 else np.ones(samples + 1)


def _size(difference: Array, unit: Array) -> Array:
    return np.sqrt(np.sum((difference / unit) ** 2, axis=(1, 2)))
