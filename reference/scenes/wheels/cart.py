"""A grocery cart that coasts: two wheels on a fixed axle, two free casters that trail behind their kingpins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.body import Triple
from reference.checks import Positive
from reference.joints import Joint, Pin, Skate
from reference.mechanism import Body, Mechanism
from reference.plane import components
from reference.scenes.wheels.casters import Casters
from reference.scenes.wheels.coasting import CoastingScene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Cart(CoastingScene):
    """c = (x, y, theta of the axle's middle; the casters' directions in the world), nu = (speed, turning rate).

    mass [kg] and inertia [kg m^2] of the cart, its centre of mass `centre` [m] ahead of the axle; kingpins `front` [m]
    ahead, `width` [m] apart; casters with their wheel `trail` [m] and centre of mass `caster_centre` [m] behind the
    kingpin. speed [m/s] and turning_rate [rad/s] of the axle, angles [rad] of the casters against the cart (0: trailing
    as when going ahead) at t = 0. The fixed axle's two wheels stop the same motion: one row is modelled, and with
    `redundant` both. Raises InvalidMechanism for numbers not finite or lengths and masses not positive.
    """

    name: ClassVar[str] = "cart"
    source: ClassVar[str] = "section 18.5, contact with ideal wheels and skates; box 18.3"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    centre: float = 0.4
    front: float = 0.7
    width: Positive = 0.4
    trail: Positive = 0.1
    caster_mass: Positive = 0.1
    caster_inertia: Positive = 1e-3
    caster_centre: float = 0.05
    speed: float = 1.0
    turning_rate: float = 1.0
    angles: tuple[float, float] = (1.5, -2.5)
    pose: Triple = (0.0, 0.0, 0.0)
    redundant: bool = False
    duration: Positive = 3.0
    horizon: Positive = 3.0

    @property
    def casters(self) -> Casters:
        return Casters(((self.front, self.width / 2), (self.front, -self.width / 2)), self.trail)

    @property
    def coordinates(self) -> int:
        return 5

    @property
    def start(self) -> Array:
        directions = [self.pose[2] + angle for angle in self.angles]
        return np.array([*self.pose, *directions, self.speed, self.turning_rate])

    @property
    def inertias(self) -> Array:
        caster = [self.caster_mass, self.caster_mass, self.caster_inertia]
        return np.array([self.mass, self.mass, self.inertia, *caster, *caster])

    def coordinate_rates(self, coordinates: NDArray[Any], quasi: NDArray[Any]) -> NDArray[Any]:
        heading, directions = coordinates[..., 2], coordinates[..., 3:]
        speed, turning = quasi[..., 0], quasi[..., 1]
        own = self.casters.turning_rates(directions - heading[..., None], speed, turning)
        moved = np.stack([speed * np.cos(heading), speed * np.sin(heading), turning], axis=-1)
        return np.concatenate([moved, own], axis=-1)

    def allowed(self, coordinates: NDArray[Any]) -> NDArray[Any]:
        heading, directions = coordinates[..., 2], coordinates[..., 3:]
        columns = []
        for speed, turning in ((1.0, 0.0), (0.0, 1.0)):
            own = self.casters.turning_rates(directions - heading[..., None], speed, turning)
            parts = [*components(heading, speed, self.centre * turning), turning + 0 * heading]
            for index, (x, y) in enumerate(self.casters.places):
                kingpin = components(heading, speed - y * turning, x * turning)
                swung = components(directions[..., index], 0.0, -self.caster_centre * own[..., index])
                parts += [kingpin[0] + swung[0], kingpin[1] + swung[1], own[..., index]]
            columns.append(np.stack(parts, axis=-1))
        return np.stack(columns, axis=-1)

    def poses(self, coordinates: Array) -> Array:
        heading = coordinates[..., 2]
        ahead = components(heading, self.centre, 0.0)
        out = [np.stack([coordinates[..., 0] + ahead[0], coordinates[..., 1] + ahead[1], heading], axis=-1)]
        for index, (x, y) in enumerate(self.casters.places):
            kingpin = components(heading, x, y)
            behind = components(coordinates[..., 3 + index], self.caster_centre, 0.0)
            place = [coordinates[..., axis] + kingpin[axis] - behind[axis] for axis in (0, 1)]
            out.append(np.stack([*place, coordinates[..., 3 + index]], axis=-1))
        return np.stack(out, axis=-2)

    def mechanism(self) -> Mechanism:
        c, nu = self.start[: self.coordinates], self.start[self.coordinates :]
        poses, twists = self.poses(c), (self.allowed(c) @ nu).reshape(3, 3)
        names = ("cart", "left caster", "right caster")
        bodies = tuple(
            Body(name, float(mass), float(inertia), tuple(pose.tolist()), tuple(twist.tolist()))
            for name, (mass, _, inertia), pose, twist in zip(
                names, self.inertias.reshape(3, 3), poses, twists, strict=True
            )
        )
        joints: list[Joint] = [Skate("axle", None, "cart", (-self.centre, 0.0))]
        if self.redundant:
            joints = [
                Skate("left wheel", None, "cart", (-self.centre, self.width / 2)),
                Skate("right wheel", None, "cart", (-self.centre, -self.width / 2)),
            ]
        for name, (x, y) in zip(names[1:], self.casters.places, strict=True):
            joints.append(Pin(f"{name}'s kingpin", "cart", name, (x - self.centre, y), (self.caster_centre, 0.0)))
            joints.append(Skate(f"{name}'s wheel", None, name, (self.caster_centre - self.trail, 0.0)))
        return Mechanism(bodies, tuple(joints))
