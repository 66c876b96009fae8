"""A person on one foot, as trunk, thighs and shanks: an open chain of five links that falls without a muscle.

A standing foot rests on the ground and is part of it, so its shank is the leg without the foot; a lifted foot goes with
its shank. The ankles are pins in the ground, at y = 0. Two feet: `reference.scenes.person_two_feet`.

The truth uses as many coordinates as there are freedoms, and no joint force (embedding): every pose is a function of
them, velocities V = T u', and T^T M T u'' = T^T (f - M dT/dt u'). On one foot u are the five angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Positive
from reference.joints import Joint, Pin
from reference.kept import kept
from reference.mechanism import Body, Mechanism
from reference.numerics import windows
from reference.numerics.integration import units_of_motion
from reference.scene import Scene
from reference.scenes.person_segments import HEAD_ARMS_TRUNK, SHANK, SHANK_AND_FOOT, THIGH, Segment
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

NAMES = ("left shank", "left thigh", "trunk", "right thigh", "right shank")


@dataclass(frozen=True)
class OneFoot(Scene):
    """Standing on the left foot: `mass` [kg] of the whole person, `height` [m], gravity [m/s^2].

    Angles [rad] at the start, from rest, of the upward lines ankle-knee, knee-hip and hip-shoulder from the upward
    vertical, and of the lifted leg's hip-knee and knee-ankle from the downward vertical; all counter-clockwise.
    """

    name: ClassVar[str] = "person_one_foot"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a model of the human body, one foot on the ground"
    reach: ClassVar[float] = 1.0  # the duration ends where the ground, which is no joint, would be met
    mass: Positive = 75.0
    height: Positive = 1.75
    gravity: float = 9.81
    left_shank: float = -0.02
    left_thigh: float = 0.05
    trunk: float = 0.0
    right_thigh: float = 1.2
    right_shank: float = -0.6
    duration: Positive = 0.25  # then the lifted foot meets the ground, which is no joint
    horizon: Positive = 0.25

    @property
    def segments(self) -> tuple[Segment, ...]:
        """In the order of the bodies; the lifted foot goes with its shank."""
        return (SHANK, THIGH, HEAD_ARMS_TRUNK, THIGH, SHANK_AND_FOOT)

    @property
    def feet(self) -> float | None:
        """Distance of the ankles on the ground [m], or None for one foot."""
        return None

    @property
    def start(self) -> tuple[float, ...]:
        """The coordinates u at t = 0: the bodies' angles, of the x axis along the segment away from the left ankle."""
        up, down = math.pi / 2, -math.pi / 2
        return (
            self.left_shank + up,
            self.left_thigh + up,
            self.trunk + up,
            self.right_thigh + down,
            self.right_shank + down,
        )

    @kept
    def lengths(self) -> Array:
        """(5,) [m]."""
        return np.array([segment.length * self.height for segment in self.segments])

    @kept
    def _behind(self) -> Array:
        """(5,) [m] from each body's joint nearer to the left ankle to its centre of mass, along its x axis."""
        centres = np.array([segment.centre for segment in self.segments])
        centres[:2] = 1 - centres[:2]  # the left leg is walked upwards, from its lower ends
        return centres * self.lengths

    @kept
    def masses(self) -> Array:
        """(5,) [kg]."""
        return np.array([segment.mass * self.mass for segment in self.segments])

    @kept
    def inertias(self) -> Array:
        """(5,) [kg m^2] about the centres of mass."""
        gyration = np.array([segment.gyration for segment in self.segments]) * self.lengths
        return self.masses * gyration**2

    def angle_rates(self, coordinates: Any) -> tuple[Any, Any]:
        """The bodies' angles (..., 5), and the matrix (..., 5, freedoms) of their rates."""
        identity = np.eye(5)
        return coordinates, np.broadcast_to(identity, (*coordinates.shape[:-1], 5, 5))

    def tangent(self, coordinates: Any) -> tuple[Any, Any]:
        """Poses (..., 5, 3) and T (..., 15, freedoms), the velocities of all bodies per unit of each coordinate's
        rate.
        """
        angle, turning = self.angle_rates(coordinates)
        cosine, sine = np.cos(angle), np.sin(angle)
        # Which segments lead, from the left ankle, to each centre of mass, and how far along them it is.
        along = np.zeros((5, 5))
        along[1, 0] = along[2, 0] = along[3, 0] = along[4, 0] = self.lengths[0]
        along[2, 1] = along[3, 1] = along[4, 1] = self.lengths[1]
        along[4, 3] = self.lengths[3]
        along[np.arange(5), np.arange(5)] = self._behind
        pose = np.stack([cosine @ along.T, sine @ along.T, angle], axis=-1)
        across = np.stack(
            [
                -(along * sine[..., None, :]) @ turning,
                (along * cosine[..., None, :]) @ turning,
                turning + 0 * cosine[..., :1, None],
            ],
            axis=-2,
        )
        return pose, across.reshape((*across.shape[:-3], 15, across.shape[-1]))

    def accelerations(self, coordinates: Array, rates: Array) -> Array:
        """u'' (..., freedoms), the embedding above; dT/dt is exact by a complex step along the motion."""
        step = 1e-100
        _, tangent = self.tangent(coordinates + 1j * step * rates)
        bias = (tangent.imag @ rates[..., None])[..., 0] / step
        tangent = tangent.real
        weights = np.stack([self.masses, self.masses, self.inertias], axis=-1).reshape(-1)
        applied = np.tile([0.0, -self.gravity, 0.0], 5)
        left = np.swapaxes(tangent, -1, -2) @ (weights[:, None] * tangent)
        right = np.swapaxes(tangent, -1, -2) @ (weights * (applied - bias))[..., None]
        return np.linalg.solve(left, right)[..., 0]

    def rates(self, state: Array) -> Array:
        """d/dt of (u, u') (..., 2 freedoms): what is integrated."""
        half = state.shape[-1] // 2
        rates = state[..., half:]
        return np.concatenate([rates, self.accelerations(state[..., :half], rates)], axis=-1)

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """u and u' (times, freedoms) at times t >= 0 [s]."""
        return self._states(self.times(t))

    def _states(self, times: Array) -> tuple[Array, Array]:
        state = _integrated(self, max(self.duration, float(times.max(initial=0.0))))(times)
        half = state.shape[-1] // 2
        return state[:, :half], state[:, half:]

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound on the truth's own error (times,) in u and u', by two rules."""
        return windows.error_of(self.rates, self._at_rest, self.times(t), units_of_motion(self.rates, self._at_rest))

    @property
    def _at_rest(self) -> Array:
        return np.concatenate([self.start, np.zeros(len(self.start))])

    def mechanism(self) -> Mechanism:
        pose, _ = self.tangent(np.array(self.start))
        bodies = tuple(
            Body(name, float(mass), float(inertia), tuple(place))
            for name, mass, inertia, place in zip(NAMES, self.masses, self.inertias, pose.tolist(), strict=True)
        )
        behind, ahead = -self._behind, self.lengths - self._behind
        joints: list[Joint] = [
            Pin("left ankle", None, NAMES[0], (0.0, 0.0), (behind[0], 0.0)),
            Pin("left knee", NAMES[0], NAMES[1], (ahead[0], 0.0), (behind[1], 0.0)),
            Pin("hip of trunk", NAMES[1], NAMES[2], (ahead[1], 0.0), (behind[2], 0.0)),
            Pin("right hip", NAMES[1], NAMES[3], (ahead[1], 0.0), (behind[3], 0.0)),
            Pin("right knee", NAMES[3], NAMES[4], (ahead[3], 0.0), (behind[4], 0.0)),
        ]
        if self.feet is not None:
            joints.append(Pin("right ankle", None, NAMES[4], (self.feet, 0.0), (ahead[4], 0.0)))
        return Mechanism(bodies, tuple(joints), (0.0, -self.gravity))

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, acceleration = self._placement(times)
        return Trajectory(times, pose, twist, self._mechanism.reaction(pose, acceleration))

    @cached_property
    def _mechanism(self) -> Mechanism:
        return self.mechanism()

    def placement(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (times, 5, 3) at times t >= 0 [s]."""
        return self._placement(self.times(t))

    def _placement(self, times: Array) -> tuple[Array, Array, Array]:
        coordinates, rates = self._states(times)
        step = 1e-100
        pose, tangent = self.tangent(coordinates)
        _, moved = self.tangent(coordinates + 1j * step * rates)
        along, bias = self.accelerations(coordinates, rates), moved.imag @ rates[..., None] / step
        acceleration = tangent @ along[..., None] + bias
        return pose, (tangent @ rates[..., None]).reshape(pose.shape), acceleration.reshape(pose.shape)


@lru_cache(maxsize=8)
def _integrated(person: OneFoot, until: float) -> windows.Motion:
    start = person._at_rest
    return windows.motion(person.rates, start, until, units_of_motion(person.rates, start))
