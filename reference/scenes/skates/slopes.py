"""Skates where an ideal one does what no friction does: at rest across a slope, sliding on it, and fixing a body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from reference.checks import InvalidMechanism, Positive
from reference.joints import Skate, Triple, Vector
from reference.kinds import Floats
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory


@dataclass(frozen=True)
class SkateOnSlope(Scene):
    """A body with its skate under the centre of mass on an incline: `gravity` [m/s^2] is g's part along it, to -y.

    Nothing turns it, so theta = heading + turning_rate t, and along the blade u' = -gravity sin theta: in closed form a
    cycloid, which gains no height and loses none (Neimark and Fufaev). With turning_rate 0 and the blade across the
    slope (heading 0) it rests for ever, its force being all of m g. mass [kg], inertia [kg m^2], speed [m/s] along the
    blade at t = 0. Raises InvalidMechanism for numbers not finite, or masses not positive.
    """

    name: ClassVar[str] = "skate_on_slope"
    source: ClassVar[str] = "box 18.3, eq. 18.64, under gravity"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    gravity: float = 1.0
    heading: float = 0.0
    speed: float = 0.0
    turning_rate: float = 0.0
    duration: Positive = 5.0
    horizon: Positive = 5.0

    def mechanism(self) -> Mechanism:
        start = self.motion(0.0)
        pose, twist = start.pose[0, 0].tolist(), start.twist[0, 0].tolist()
        body = Body("skate", self.mass, self.inertia, tuple(pose), tuple(twist))
        return Mechanism((body,), (Skate("blade", None, "skate", (0.0, 0.0)),), (0.0, -self.gravity))

    def _motion(self, times: Floats) -> Trajectory:
        t = times
        first, rate = self.heading, self.turning_rate
        angle, half = first + rate * t, 0.5 * rate * t
        # (cos theta - cos first)/rate = -t sin(first + half) sinc(half): no cancellation at a small rate.
        chord = t * np.sinc(half / math.pi)
        speed = self.speed - self.gravity * chord * np.sin(first + half)
        x, y = self._way(t)
        pose = np.stack([x, y, angle], axis=-1)
        twist = np.stack([speed * np.cos(angle), speed * np.sin(angle), np.full_like(t, rate)], axis=-1)
        force = self.mass * (speed * rate + self.gravity * np.cos(angle))
        return Trajectory(t, pose[:, None, :], twist[:, None, :], force[:, None])

    def _way(self, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """x and y of the blade [m]: the integrals of u cos theta and u sin theta."""
        first, rate, pull = self.heading, self.turning_rate, self.gravity
        if abs(rate) * float(t.max(initial=0.0)) < 1:
            # The closed form divides by the rate's square. Within a radian a few nodes are as exact as rounding.
            nodes, weights = np.polynomial.legendre.leggauss(12)
            when = 0.5 * t[..., None] * (1 + nodes)
            angle, half = first + rate * when, 0.5 * rate * when
            speed = self.speed - pull * when * np.sinc(half / math.pi) * np.sin(first + half)
            share = 0.5 * t[..., None] * weights * speed
            return np.sum(share * np.cos(angle), axis=-1), np.sum(share * np.sin(angle), axis=-1)
        angle = first + rate * t
        chord = 2 * np.sin(0.5 * rate * t) / rate  # of a circle with unit speed, along the mean heading
        middle = first + 0.5 * rate * t
        # u = free + (pull/rate) cos theta, free = speed - (pull/rate) cos first.
        free = self.speed - pull / rate * math.cos(first)
        twice = (np.sin(2 * angle) - math.sin(2 * first)) / (4 * rate)
        x = free * chord * np.cos(middle) + pull / rate * (0.5 * t + twice)
        y = free * chord * np.sin(middle) + pull / rate * (np.sin(angle) ** 2 - math.sin(first) ** 2) / (2 * rate)
        return x, y


@dataclass(frozen=True)
class HeldBySkates(Scene):
    """A body on skates whose axles do not meet in one point: no freedom of velocity is left, and it stays, on a slope.

    Two skates always leave one freedom (their axles meet in a point, the centre of rotation, or are parallel); so it
    takes a third, elsewhere. points [m] from the centre of mass, angles [rad] of the blades against the body; `gravity`
    [m/s^2] is g's part along the incline, to -y. Raises InvalidMechanism unless the skates hold the body.
    """

    name: ClassVar[str] = "held_by_skates"
    source: ClassVar[str] = "box 18.3, degrees of freedom by rank"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    points: tuple[Vector, ...] = ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.4))
    angles: tuple[float, ...] = (0.5, -0.5, 1.5)
    gravity: float = 1.0
    pose: Triple = (0.0, 0.0, 0.3)
    duration: Positive = 3.0
    horizon: Positive = 3.0

    def __post_init__(self) -> None:
        super().__post_init__()
        owner = f"scene {self.name!r}"
        if len(self.points) != len(self.angles):
            raise InvalidMechanism(
                f"{owner}: {len(self.points)} points and {len(self.angles)} angles; each skate has one"
            )
        _, freedoms = self.mechanism().degrees_of_freedom()
        if freedoms:
            raise InvalidMechanism(
                f"{owner}: these {len(self.points)} skates leave {freedoms} freedom of velocity, so the body moves; "
                f"their axles must not all be parallel or meet in one point"
            )

    def mechanism(self) -> Mechanism:
        joints = tuple(
            Skate(f"skate {index + 1}", None, "body", point, angle)
            for index, (point, angle) in enumerate(zip(self.points, self.angles, strict=True))
        )
        return Mechanism((Body("body", self.mass, self.inertia, self.pose),), joints, (0.0, -self.gravity))

    def _motion(self, times: Floats) -> Trajectory:
        pose = np.broadcast_to(np.array(self.pose, dtype=float), (len(times), 1, 3)).copy()
        still = np.zeros_like(pose)
        return Trajectory(times, pose, still, self.mechanism().reaction(pose, still))
