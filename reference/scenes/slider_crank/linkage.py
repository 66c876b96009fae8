"""The slider-crank in formulas: position, velocity, acceleration, dead centres, stroke; its inertia and its guide
force.

The crank turns about the origin; the slider moves along the line y = offset. With crank r, rod l, offset e and crank
angle theta, the rod's angle beta follows from r sin(theta) + l sin(beta) = e, and x = r cos(theta) + l cos(beta). The
two branches are cos(beta) > 0 (+1) and cos(beta) < 0 (-1). A loop that the chapter calls "difficult or impossible to
express with formulas"; this one isn't.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Sign, Valid, validated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SliderCrank(Valid):
    """Crank and rod [m], the slot's height `offset` [m], and the `branch`, +1 or -1.

    Raises InvalidMechanism unless the crank can turn fully, |offset| < rod - crank: at equality the branches meet.
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

    @validated
    def rod_sine(self, theta: Complexes) -> Any:
        """sin(beta) (...) [1] for crank angles (...) [rad]."""
        return self._rod(theta)[0]

    # Those that begin with an underscore check nothing: an integration asks for them thousands of times.

    def _rod(self, theta: Any) -> tuple[Any, Any]:
        sine = (self.offset - self.crank * np.sin(theta)) / self.rod
        return sine, self.branch * np.sqrt((1 - sine) * (1 + sine))

    @validated
    def rod_angle(self, theta: ArrayLike) -> Array:
        """beta (...) [rad], from the crank pin to the slider, continuous in theta."""
        sine = self.rod_sine(np.asarray(theta))
        return np.arcsin(sine) if self.branch == 1 else math.pi - np.arcsin(sine)

    @validated
    def rod_rates(self, theta: Complexes) -> tuple[Any, Any]:
        """beta' and beta'' with respect to theta (...): r cos(theta) + l cos(beta) beta' = 0, and once more."""
        return self._rod_rates(theta)

    def _rod_rates(self, theta: Any) -> tuple[Any, Any]:
        sine, cosine = self._rod(theta)
        first = -self.crank * np.cos(theta) / (self.rod * cosine)
        return first, (self.crank * np.sin(theta) / self.rod + sine * first**2) / cosine

    @validated
    def position(self, theta: Complexes) -> Any:
        """x (...) [m] of the slider; analytic, so a complex step passes."""
        return self.crank * np.cos(theta) + self.rod * self._rod(theta)[1]

    @validated
    def position_rates(self, theta: Complexes) -> tuple[Any, Any]:
        """x' and x'' with respect to theta (...) [m]: velocity x' w, acceleration x'' w^2 + x' alpha."""
        return self._position_rates(theta)

    def _position_rates(self, theta: Any) -> tuple[Any, Any]:
        sine, cosine = self._rod(theta)
        first, second = self._rod_rates(theta)
        return (
            -self.crank * np.sin(theta) - self.rod * sine * first,
            -self.crank * np.cos(theta) - self.rod * (cosine * first**2 + sine * second),
        )

    def dead_centres(self) -> tuple[float, float]:
        """The crank angles [rad] at which crank and rod are in line: stretched, then folded.

        There the slider stands still, x' = 0, and can't drive the crank.
        """
        stretched = math.asin(self.offset / (self.rod + self.crank))
        folded = math.pi + math.asin(self.offset / (self.rod - self.crank))
        if self.branch == 1:
            return stretched, folded
        return math.pi - stretched, 3 * math.pi - folded

    def stroke(self) -> float:
        """The slider's way between its dead centres [m]."""
        return math.sqrt((self.rod + self.crank) ** 2 - self.offset**2) - math.sqrt(
            (self.rod - self.crank) ** 2 - self.offset**2
        )


@dataclass(frozen=True)
class MovingSliderCrank(Valid):
    """A slider-crank with masses: uniform crank and rod, a slider, all [kg]; gravity [m/s^2] downwards, across the
    slot.
    """

    shape: SliderCrank
    crank_mass: Positive
    rod_mass: Positive
    slider_mass: Positive
    gravity: float

    def _centre_of_rod(self, theta: Any) -> tuple[Any, Any]:
        """First and second derivatives with respect to theta of the rod's centre: each (x, y) (...) [m]."""
        r, e = self.shape.crank, self.shape
        first, second = e._position_rates(theta)
        # The centre is halfway between the crank pin and the slider.
        return (
            ((first - r * np.sin(theta)) / 2, r * np.cos(theta) / 2),
            ((second - r * np.cos(theta)) / 2, -r * np.sin(theta) / 2),
        )

    @validated
    def inertia(self, theta: Complexes) -> tuple[Any, Any]:
        """The reduced inertia J(theta) [kg m^2] and its derivative: the kinetic energy is J w^2 / 2."""
        return self._inertia(theta)

    def _inertia(self, theta: Any) -> tuple[Any, Any]:
        x1, x2 = self.shape._position_rates(theta)
        b1, b2 = self.shape._rod_rates(theta)
        (cx1, cy1), (cx2, cy2) = self._centre_of_rod(theta)
        rod_inertia = self.rod_mass * self.shape.rod**2 / 12
        value = (
            self.crank_mass * self.shape.crank**2 / 3
            + self.rod_mass * (cx1**2 + cy1**2)
            + rod_inertia * b1**2
            + self.slider_mass * x1**2
        )
        slope = 2 * (self.rod_mass * (cx1 * cx2 + cy1 * cy2) + rod_inertia * b1 * b2 + self.slider_mass * x1 * x2)
        return value, slope

    @validated
    def potential(self, theta: Complexes) -> tuple[Any, Any]:
        """V(theta) [J] and its derivative; the slider keeps its height."""
        moment = self.gravity * self.shape.crank * (self.crank_mass + self.rod_mass) / 2
        return moment * np.sin(theta), moment * np.cos(theta)

    @validated
    def acceleration(self, theta: Complexes, rate: Complexes) -> Any:
        """theta'' (...) [rad/s^2] when nothing drives it: J theta'' + J' theta'^2 / 2 + V' = 0."""
        inertia, inertia_slope = self._inertia(theta)
        return -(inertia_slope * rate**2 / 2 + self.potential(theta)[1]) / inertia

    @validated
    def torque(self, theta: Complexes, rate: Complexes, acceleration: Complexes) -> Any:
        """What the drive must give the crank (...) [N m] for this motion."""
        inertia, inertia_slope = self.inertia(theta)
        return inertia * acceleration + inertia_slope * rate**2 / 2 + self.potential(theta)[1]

    @validated
    def guide_force(self, theta: Complexes, rate: Complexes, acceleration: Complexes) -> Any:
        """The slot's force on the slider (...) [N], upwards: from the rod's and the slider's balance alone.

        Moments about the crank pin of rod and slider together: the slot's force has the lever l cos(beta).
        """
        shape = self.shape
        sine, cosine = shape._rod(theta)
        b1, b2 = shape.rod_rates(theta)
        x1, x2 = shape.position_rates(theta)
        _, (cx2, cy2) = self._centre_of_rod(theta)
        (cx1, cy1), _ = self._centre_of_rod(theta)
        ax, ay = cx2 * rate**2 + cx1 * acceleration, cy2 * rate**2 + cy1 * acceleration
        rod_acceleration = b2 * rate**2 + b1 * acceleration
        slider = x2 * rate**2 + x1 * acceleration
        arm_x, arm_y = shape.rod * cosine, shape.rod * sine
        moment = (
            self.rod_mass * shape.rod**2 / 12 * rod_acceleration
            + self.rod_mass * (arm_x / 2 * (ay + self.gravity) - arm_y / 2 * ax)
            + self.slider_mass * (arm_x * self.gravity - arm_y * slider)
        )
        return moment / arm_x
