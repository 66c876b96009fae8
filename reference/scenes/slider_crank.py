"""The slider-crank in closed form, with scenes of a driven and a free crank, and scenes in which methods fail.

The crank turns about the origin; the slider moves along the line y = offset. With crank r, rod l, offset e and crank
angle theta, the rod's angle beta satisfies r sin(theta) + l sin(beta) = e. The slider is at x = r cos(theta) + l
cos(beta). `branch` is the sign of cos(beta).

The block slides with its centre of mass in a slot, and a drive of rate zero keeps its angle. Methods fail if a rod's
end slides in the slot without a block, and if a slider starts to move near a dead centre.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Sign, Valid, validated
from reference.embedding import EmbeddedScene
from reference.joints import Drive, Joint, Pin, Slot, bodies_of
from reference.mechanism import Mechanism
from reference.plane import placed
from reference.scene import PlacedScene
from reference.validators import Array


@dataclass(frozen=True)
class SliderCrank(Valid):
    """Crank and rod [m], the slot's height `offset` [m], and the `branch`, +1 or -1.

    Raises InvalidMechanism unless the crank can turn fully, that is, |offset| < rod - crank.
    """

    crank: Positive
    rod: Positive
    offset: float = 0.0
    branch: Sign = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if not abs(self.offset) < self.rod - self.crank:
            raise InvalidMechanism(
                f"slider-crank: offset is {self.offset!r}; for a full turn it must stay below rod - crank = "
                f"{self.rod - self.crank:.6g} in size"
            )

    def _rod(self, theta: Any) -> tuple[Any, Any]:
        """sin(beta) and cos(beta) without checks of the argument.

        For a complex step the cosine's imaginary part is computed separately, since (1 - sine)(1 + sine) would round a
        small sine.
        """
        sine = (self.offset - self.crank * np.sin(theta)) / self.rod
        flat = np.real(sine)
        cosine = self.branch * np.sqrt((1 - flat) * (1 + flat))
        return sine, cosine - 1j * flat * np.imag(sine) / cosine if np.iscomplexobj(sine) else cosine

    @validated
    def rod_angle(self, theta: ArrayLike) -> Array:
        """beta (...) [rad], the direction from the crank pin to the slider, continuous in theta."""
        sine, _ = self._rod(np.asarray(theta))
        return np.arcsin(sine) if self.branch == 1 else math.pi - np.arcsin(sine)

    @validated
    def position(self, theta: Complexes) -> Any:
        """x (...) [m] of the slider; analytic."""
        return self.crank * np.cos(theta) + self.rod * self._rod(theta)[1]

    @validated
    def rates(self, theta: Complexes) -> tuple[Any, Any]:
        """The derivatives of beta [1] and x [m] with respect to theta (...), analytic."""
        return self._rates(theta)

    def _rates(self, theta: Any) -> tuple[Any, Any]:
        sine, cosine = self._rod(theta)
        turn = -self.crank * np.cos(theta) / (self.rod * cosine)
        return turn, -self.crank * np.sin(theta) - self.rod * sine * turn

    def dead_centres(self) -> tuple[float, float]:
        """The crank angles [rad] at which crank and rod are in line, first stretched and then folded.

        At these angles the slider can't drive the crank, since x' = 0.
        """
        stretched = math.asin(self.offset / (self.rod + self.crank))
        folded = math.pi + math.asin(self.offset / (self.rod - self.crank))
        if self.branch == 1:
            return stretched, folded
        return math.pi - stretched, 3 * math.pi - folded

    def stroke(self) -> float:
        """The slider's distance between its dead centres [m]."""
        return math.sqrt((self.rod + self.crank) ** 2 - self.offset**2) - math.sqrt(
            (self.rod - self.crank) ** 2 - self.offset**2
        )


@dataclass(frozen=True)
class DrivenSliderCrank(EmbeddedScene):
    """The crank turns at a constant `rate` [rad/s] from `angle` [rad]; lengths [m], masses [kg], gravity [m/s^2].

    `slider_inertia` [kg m^2] has no effect, since the slider doesn't rotate.
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
    horizon: Positive = 2 * math.pi / 10  # stable, since the crank is prescribed

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self.shape  # checks the lengths

    @cached_property
    def shape(self) -> SliderCrank:
        return SliderCrank(self.crank, self.rod, self.offset, self.branch)

    @property
    def start(self) -> Array:
        """The crank's angle [rad] and rate [rad/s]."""
        return np.array([self.angle, self.rate])

    def tangent(self, coordinates: Any) -> tuple[Any, Any]:
        theta, shape, r = coordinates[..., 0], self.shape, self.crank
        sine, cosine, zero = np.sin(theta), np.cos(theta), 0 * theta
        position, (turn, slide) = shape.position(theta), shape._rates(theta)
        poses = (
            (r * cosine / 2, r * sine / 2, theta),
            ((r * cosine + position) / 2, (r * sine + self.offset) / 2, shape.rod_angle(np.real(theta))),
            (position, self.offset + zero, zero),
        )
        rates = (-r * sine / 2, r * cosine / 2, 1 + zero)
        rates += ((slide - r * sine) / 2, r * cosine / 2, turn, slide, zero, zero)
        pose = np.stack([np.stack(np.broadcast_arrays(*row), axis=-1) for row in poses], axis=-2)
        return pose, np.stack(rates, axis=-1)[..., None]

    def mechanism(self) -> Mechanism:
        pose, tangent = self.tangent(np.array([self.angle]))
        twist = (tangent[..., 0] * self.rate).reshape(3, 3)
        masses = (self.crank_mass, self.rod_mass, self.slider_mass)
        inertias = (self.crank_mass * self.crank**2 / 12, self.rod_mass * self.rod**2 / 12, self.slider_inertia)
        names = ("crank", "rod", "slider")
        bodies = bodies_of(names, masses, inertias, pose, twist)
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

    def _states(self, times: Array) -> tuple[Array, Array]:
        if not self.driven:
            return super()._states(times)
        return (self.angle + self.rate * times)[:, None], np.full((len(times), 1), self.rate)

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        return self.embedded(*self._states(times), np.zeros((len(times), 1)) if self.driven else None)[1:]

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound (times,) on the error of the motion [rad, rad/s], which is zero for a prescribed motion."""
        return np.zeros(len(self.times(t))) if self.driven else super().truth_error(t)

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        """The sign of cos(beta): +1 if the slider is to the right of the crank pin, -1 if it is to the left."""
        pin = 2 * pose[..., 0, 0]  # the crank's centre is halfway to its pin
        return np.sign(pose[..., 2, 0] - pin).astype(int)


@dataclass(frozen=True)
class FreeSliderCrank(DrivenSliderCrank):
    """The free slider-crank under gravity, which starts at `angle` with `rate`."""

    name: ClassVar[str] = "free_slider_crank"
    driven: ClassVar[bool] = False
    duration: Positive = 2.0
    horizon: Positive = 2.0  # an error of the energy causes a phase error that is linear in time


@dataclass(frozen=True)
class RodEndInSlot(DrivenSliderCrank):
    """The driven slider-crank with the rod's end in the slot and without a sliding block.

    Crank and rod move as with a block, and `slider_mass` has no effect.
    """

    name: ClassVar[str] = "rod_end_in_slot"

    def mechanism(self) -> Mechanism:
        with_slider = super().mechanism()
        joints = tuple(joint for joint in with_slider.joints if "slider" not in (joint.first, joint.second))
        end = next(joint for joint in with_slider.joints if isinstance(joint, Pin) and joint.second == "slider")
        guide = next(joint for joint in with_slider.joints if isinstance(joint, Slot))
        slot = replace(guide, second="rod", second_point=end.first_point)
        return replace(with_slider, bodies=with_slider.bodies[:2], joints=(*joints, slot))

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        pose, twist, acceleration = (part[:, :2] for part in super().placement(times))
        return pose, twist, acceleration

    def _branch_of(self, pose: Array) -> Any:
        """+1 if the rod points to the right, -1 if to the left."""
        return np.sign(np.cos(pose[..., 1, 2])).astype(int)


@dataclass(frozen=True)
class SliderAtDeadCentre(FreeSliderCrank):
    """The slider-crank released at rest near the outer dead centre, under gravity along the slot.

    The `angle` [rad] of the start from the dead centre determines when and in which direction the crank moves.
    """

    name: ClassVar[str] = "slider_at_dead_centre"
    angle: float = 1e-6
    rate: float = 0.0
    duration: Positive = 1.5
    horizon: Positive = 1.5

    @property
    def angle_unit(self) -> float:
        """The angle [rad] from the dead centre at the start, to which errors are proportional."""
        return min(1.0, abs(self.angle)) or 1.0

    def mechanism(self) -> Mechanism:
        return replace(super().mechanism(), gravity=(-self.gravity, 0.0))


@dataclass(frozen=True)
class SlottedLever(PlacedScene):
    """The crank turns at a constant `rate` [rad/s] from `angle` [rad]; the crank's pin slides in a slot of the lever.

    `crank` and `lever` [m] are lengths of uniform bars with masses [kg]. The lever's pivot is at (-distance, 0) [m].
    The slot begins at the lever's pivot, at the angle `slant` [rad] to the lever's bar, so that the bar's centre of
    mass is not on the slot. Raises InvalidMechanism unless crank < distance, so that the lever swings.
    """

    name: ClassVar[str] = "slotted_lever"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a slider-crank whose slot is in a moving body"
    crank: Positive = 0.3
    lever: Positive = 1.4
    distance: Positive = 0.8
    slant: float = 0.5
    crank_mass: Positive = 0.3
    lever_mass: Positive = 1.0
    gravity: float = 9.81
    angle: float = 0.5
    rate: float = 10.0
    duration: Positive = 2 * math.pi / 10
    horizon: Positive = 2 * math.pi / 10  # stable, since the crank is prescribed

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.crank < self.distance:
            raise InvalidMechanism(
                f"{self._owner()}: crank is {self.crank!r} m; it must be shorter than the distance {self.distance!r} m "
                "of the pivots"
            )

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        theta = self.angle + self.rate * times
        crank = self.crank * np.exp(1j * theta)
        reach = self.distance + crank  # Vector from the lever's pivot to the crank's pin, with a positive real part.
        turning, bending = self.rate * 1j * crank / reach, -(self.rate**2) * crank / reach  # P'/reach and P''/reach.
        angle, rate = np.angle(reach), turning.imag
        # The angle's second derivative is the imaginary part of log(reach)'' = P''/reach - (P'/reach)^2.
        turned = (bending - turning**2).imag
        bar = 0.5 * self.lever * np.exp(-1j * self.slant) * reach / np.abs(reach)
        zero = np.zeros_like(times)
        pose, twist, acceleration = (
            np.stack([placed(*of_crank), placed(*of_lever)], axis=1)
            for of_crank, of_lever in (
                ((crank / 2, theta), (bar - self.distance, angle - self.slant)),
                ((0.5j * self.rate * crank, zero + self.rate), (1j * rate * bar, rate)),
                ((-0.5 * self.rate**2 * crank, zero), ((1j * turned - rate**2) * bar, turned)),
            )
        )
        return pose, twist, acceleration

    def mechanism(self) -> Mechanism:
        pose, twist, _ = self.placement(np.zeros(1))
        masses = (self.crank_mass, self.lever_mass)
        inertias = (self.crank_mass * self.crank**2 / 12, self.lever_mass * self.lever**2 / 12)
        bodies = bodies_of(("crank", "lever"), masses, inertias, pose[0], twist[0])
        joints = (
            Pin("A", None, "crank", (0.0, 0.0), (-self.crank / 2, 0.0)),
            Pin("D", None, "lever", (-self.distance, 0.0), (-self.lever / 2, 0.0)),
            Slot("slot", "lever", "crank", (-self.lever / 2, 0.0), self.slant, (self.crank / 2, 0.0)),
            Drive("drive", None, "crank", self.rate, self.angle),
        )
        return Mechanism(bodies, joints, (0.0, -self.gravity))
