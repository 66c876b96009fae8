"""The crank and slotted lever, a slider-crank whose slot turns: a pin on the crank slides in a lever that swings.

The crank turns about the origin, the lever about a pivot at a distance d ahead of it, so that with the crank's pin P
and the slot's angle phi, from the pivot D, phi is the direction of P - D: one arctangent, and its derivatives.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism, Positive
from reference.joints import Drive, Pin, Slot, bodies_of
from reference.mechanism import Mechanism
from reference.plane import from_complex
from reference.scene import PlacedScene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlottedLever(PlacedScene):
    """The crank turns at a constant `rate` [rad/s] from `angle` [rad]; its pin slides in a straight slot of the lever.

    crank and lever [m], the lever's pivot at (-distance, 0) [m]; uniform bars of crank_mass and lever_mass [kg];
    gravity [m/s^2] downwards. The slot goes from the lever's pivot on, as long as it needs to be, turned by `slant`
    [rad] against the lever's bar, so that the bar's centre of mass is not on it. Raises InvalidMechanism unless the
    crank is shorter than the distance: the lever then swings to and fro, and the pin never meets its pivot.
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
    horizon: Positive = 2 * math.pi / 10  # nothing is unstable: the crank is prescribed

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
        reach = self.distance + crank  # from the lever's pivot to the pin; its real part is positive
        turning, bending = self.rate * 1j * crank / reach, -(self.rate**2) * crank / reach  # P'/reach and P''/reach
        angle, rate = np.angle(reach), turning.imag
        # log(reach)'' = P''/reach - (P'/reach)^2, and its imaginary part is the angle's.
        acceleration = (bending - turning**2).imag
        bar = 0.5 * self.lever * np.exp(-1j * self.slant) * reach / np.abs(reach)
        zero = np.zeros_like(times)
        parts = []
        for centres, turns in (
            ((crank / 2, bar - self.distance), (theta, angle - self.slant)),
            ((0.5j * self.rate * crank, 1j * rate * bar), (zero + self.rate, rate)),
            ((-0.5 * self.rate**2 * crank, (1j * acceleration - rate**2) * bar), (zero, acceleration)),
        ):
            bodies = [
                np.column_stack([from_complex(centre), turn]) for centre, turn in zip(centres, turns, strict=True)
            ]
            parts.append(np.stack(bodies, axis=1))
        return parts[0], parts[1], parts[2]

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
