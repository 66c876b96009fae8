"""A slider-crank driven at a constant rate, and one let go: crank, rod and a sliding block of its own.

The block has a slot at its centre of mass and keeps its angle by a drive of rate zero: a slot alone would leave it
free to turn about its pin, a third freedom that no slider-crank has. Where
methods fail: the rod's own end in the slot, and a slider that has to start the crank.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, Positive, Sign, validated
from reference.joints import Drive, Joint, Pin, Slot
from reference.kinds import Floats
from reference.mechanism import Body, Mechanism
from reference.numerics import windows
from reference.numerics.integration import Rates, units_of_motion
from reference.scene import Scene
from reference.scenes.slider_crank.linkage import MovingSliderCrank, SliderCrank
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


def _rates_of(moving: MovingSliderCrank) -> Rates:
    def rates(state: Array) -> Array:
        theta, rate = state[..., 0], state[..., 1]
        return np.stack([rate, moving.acceleration(theta, rate)], axis=-1)

    return rates


@lru_cache(maxsize=8)
def _integrated(moving: MovingSliderCrank, angle: float, rate: float, until: float, unit: float) -> windows.Motion:
    rates = _rates_of(moving)
    return windows.motion(rates, [angle, rate], until, units_of_motion(rates, [angle, rate], unit))


@dataclass(frozen=True)
class DrivenSliderCrank(Scene):
    """The crank turns at a constant `rate` [rad/s] from `angle` [rad]; lengths [m], masses [kg], gravity [m/s^2].

    The slider's `slider_inertia` [kg m^2] never acts: it doesn't turn.
    """

    name: ClassVar[str] = "driven_slider_crank"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a slider-crank"
    driven: ClassVar[bool] = True
    crank: Positive = 0.3
    rod: Positive = 1.0
    offset: float = 0.0
    branch: Sign = 1
    crank_mass: Positive = 0.3
    rod_mass: Positive = 1.0
    slider_mass: Positive = 0.5
    slider_inertia: Positive = 1e-3
    gravity: float = 9.81
    angle: float = 0.5
    rate: float = 10.0
    duration: Positive = 2 * math.pi / 10
    horizon: Positive = 2 * math.pi / 10  # nothing is unstable: the crank is prescribed

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self.moving  # refuses lengths and masses that can't be

    @cached_property
    def moving(self) -> MovingSliderCrank:
        shape = SliderCrank(self.crank, self.rod, self.offset, self.branch)
        return MovingSliderCrank(shape, self.crank_mass, self.rod_mass, self.slider_mass, self.gravity)

    def crank_motion(self, t: Array) -> tuple[Array, Array, Array]:
        """Angle, rate and acceleration of the crank (times,) [rad, s]."""
        return self.angle + self.rate * t, np.full_like(t, self.rate), np.zeros_like(t)

    def _placement(self, theta: Array, rate: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """Poses, twists, accelerations (times, 3 bodies, 3)."""
        shape, r = self.moving.shape, self.crank
        sine, cosine, zero = np.sin(theta), np.cos(theta), np.zeros_like(theta)
        x, beta = shape.position(theta), shape.rod_angle(theta)
        (x1, x2), (b1, b2) = shape.position_rates(theta), shape.rod_rates(theta)

        def bodies(*rows: tuple[Array | float, Array | float, Array | float]) -> Array:
            return np.stack([np.stack([value + zero for value in row], axis=-1) for row in rows], axis=-2)

        place = bodies(
            (r * cosine / 2, r * sine / 2, theta),
            ((r * cosine + x) / 2, (r * sine + self.offset) / 2, beta),
            (x, self.offset, 0.0),
        )
        first = bodies((-r * sine / 2, r * cosine / 2, 1.0), ((x1 - r * sine) / 2, r * cosine / 2, b1), (x1, 0.0, 0.0))
        second = bodies(
            (-r * cosine / 2, -r * sine / 2, 0.0), ((x2 - r * cosine) / 2, -r * sine / 2, b2), (x2, 0.0, 0.0)
        )
        w, alpha = rate[:, None, None], acceleration[:, None, None]
        return place, first * w, second * w**2 + first * alpha

    @cached_property
    def _mechanism(self) -> Mechanism:
        theta, rate, acceleration = self.crank_motion(np.zeros(1))
        pose, twist, _ = self._placement(theta, rate, acceleration)
        masses = (self.crank_mass, self.rod_mass, self.slider_mass)
        inertias = (self.crank_mass * self.crank**2 / 12, self.rod_mass * self.rod**2 / 12, self.slider_inertia)
        names = ("crank", "rod", "slider")
        bodies = tuple(
            Body(name, mass, inertia, tuple(place), tuple(speed))
            for name, mass, inertia, place, speed in zip(
                names, masses, inertias, pose[0].tolist(), twist[0].tolist(), strict=True
            )
        )
        joints: list[Joint] = [
            Pin("A", None, "crank", (0.0, 0.0), (-self.crank / 2, 0.0)),
            Pin("B", "crank", "rod", (self.crank / 2, 0.0), (-self.rod / 2, 0.0)),
            Pin("C", "rod", "slider", (self.rod / 2, 0.0), (0.0, 0.0)),
            Slot("guide", None, "slider", (0.0, self.offset), 0.0, (0.0, 0.0)),
            Drive("level", None, "slider", 0.0, 0.0),
        ]
        if self.driven:
            joints.append(Drive("drive", None, "crank", self.rate, self.angle))
        return Mechanism(bodies, tuple(joints), (0.0, -self.gravity))

    def mechanism(self) -> Mechanism:
        return self._mechanism

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, acceleration = self._placement(*self.crank_motion(times))
        return Trajectory(times, pose, twist, self._mechanism.reaction(pose, acceleration))

    def _branch_of(self, pose: Floats) -> NDArray[np.int_]:
        """+1 where the slider is to the right of the crank pin, -1 to the left: the sign of cos(beta)."""
        pin = 2 * pose[..., 0, 0]  # the crank's centre is halfway out to its pin
        return np.sign(pose[..., 2, 0] - pin).astype(int)


@dataclass(frozen=True)
class FreeSliderCrank(DrivenSliderCrank):
    """The same, let go at `angle` with `rate`: it turns over by its own speed, and gravity acts on it."""

    name: ClassVar[str] = "free_slider_crank"
    driven: ClassVar[bool] = False
    duration: Positive = 2.0
    horizon: Positive = 2.0  # one freedom, turning: an error in the energy makes the phase drift in proportion to time

    @property
    def angle_unit(self) -> float:
        """What the crank's angle is counted in while it is integrated [rad]."""
        return 1.0

    def crank_motion(self, t: Array) -> tuple[Array, Array, Array]:
        until = max(self.duration, float(t.max(initial=0.0)))
        if t.any():
            state = _integrated(self.moving, self.angle, self.rate, until, self.angle_unit)(t)
        else:  # a mechanism needs no more than the start
            state = np.full((len(t), 2), (self.angle, self.rate), dtype=float)
        return state[:, 0], state[:, 1], self.moving.acceleration(state[:, 0], state[:, 1])

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound on the truth's own error (times,) [rad, rad/s], by two rules."""
        rates, start = _rates_of(self.moving), [self.angle, self.rate]
        return windows.error_of(rates, start, self.times(t), units_of_motion(rates, start, self.angle_unit))


@dataclass(frozen=True)
class RodEndInSlot(DrivenSliderCrank):
    """The driven slider-crank without a sliding block: the rod's own end runs in the slot, off its centre of mass.

    The motion of crank and rod is the same, since the crank is prescribed; `slider_mass` never acts.
    """

    name: ClassVar[str] = "rod_end_in_slot"

    @cached_property
    def _mechanism(self) -> Mechanism:
        whole = super()._mechanism
        kept = tuple(joint for joint in whole.joints if "slider" not in (joint.first, joint.second))
        end = next(joint for joint in whole.joints if isinstance(joint, Pin) and joint.second == "slider")
        guide = next(joint for joint in whole.joints if isinstance(joint, Slot))
        return replace(
            whole,
            bodies=whole.bodies[:2],
            joints=(*kept, replace(guide, second="rod", second_point=end.first_point)),
        )

    def _motion(self, times: NDArray[np.float64]) -> Trajectory:
        pose, twist, acceleration = (part[:, :2] for part in self._placement(*self.crank_motion(times)))
        return Trajectory(times, pose, twist, self._mechanism.reaction(pose, acceleration))

    def _branch_of(self, pose: Floats) -> Any:
        """+1 where the rod points to the right, -1 to the left."""
        return np.sign(np.cos(pose[..., 1, 2])).astype(int)


@dataclass(frozen=True)
class PushedSliderCrank(MovingSliderCrank):
    """Gravity acts along the slot, towards the crank's pivot."""

    @validated
    def potential(self, theta: Complexes) -> tuple[Any, Any]:
        """V(theta) [J] and its derivative: everything is pushed to -x."""
        r, x = self.shape.crank, self.shape.position(theta)
        first, _ = self.shape.position_rates(theta)
        cosine, sine = r * np.cos(theta), r * np.sin(theta)
        value = self.crank_mass * cosine / 2 + self.rod_mass * (cosine + x) / 2 + self.slider_mass * x
        slope = -self.crank_mass * sine / 2 + self.rod_mass * (first - sine) / 2 + self.slider_mass * first
        return self.gravity * value, self.gravity * slope


@dataclass(frozen=True)
class SliderAtDeadCentre(FreeSliderCrank):
    """Let go at rest next to the outer dead centre, everything pushed along the slot: the slider has no lever yet.

    In the dead centre itself it would stay for ever; `angle` [rad] is what decides when, and to which side, it leaves.
    """

    name: ClassVar[str] = "slider_at_dead_centre"
    angle: float = 1e-6
    rate: float = 0.0
    duration: Positive = 1.5
    horizon: Positive = 1.5

    @property
    def angle_unit(self) -> float:
        """The start's distance from the dead centre [rad]: an error in it grows as it does, and stays that part."""
        return min(1.0, abs(self.angle)) or 1.0

    @cached_property
    def moving(self) -> MovingSliderCrank:
        shape = SliderCrank(self.crank, self.rod, self.offset, self.branch)
        return PushedSliderCrank(shape, self.crank_mass, self.rod_mass, self.slider_mass, self.gravity)

    @cached_property
    def _mechanism(self) -> Mechanism:
        return replace(super()._mechanism, gravity=(-self.gravity, 0.0))
