"""The mechanism of a recipe (`reports.search.parts`).

Bodies are placed first. Each joint is placed at a point of the world, and the points on the bodies are computed from
it. So every joint is closed at the start. The velocities of the recipe are projected so that they satisfy the joints.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism
from reference.couplings import Coupling
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Body, Drive, Gear, Joint, Pin, Rod, Skate, Slot, Vector, Weld
from reference.mechanism import Mechanism
from reference.plane import components, rotated
from reference.rolling.closed_curves import Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scales import length_scale
from reports.search.parts import (
    ALL_KINDS,
    ANGLE_UNIT,
    FORCE_KINDS,
    RATE_UNIT,
    RIM_SHAPES,
    SINGULAR_KINDS,
    Recipe,
    RecipeLink,
    Rim,
    ladder,
)

Array = NDArray[np.float64]
Point = tuple[Decimal, Decimal]
# Limit for the smallest singular value of the rows divided by their largest singular value. With a smaller ratio,
# rounding changes the forces and the motion in every engine.
DEPENDENCE_LIMIT = 1e-3
SINGULAR_LIMIT = 1e-6  # Limit of the same ratio in mechanisms with toggles or folds.
# If all projected velocities are smaller, relative to those of the recipe, they are rounding errors.
MOTION_ROUNDING = 1e-12


def build(recipe: Recipe) -> Mechanism:
    """The mechanism of a recipe. Raises InvalidMechanism for an invalid recipe, for example with nearly dependent rows
    or with curves that don't fit."""
    standing = Standing(recipe)
    links = list(enumerate(recipe.links, start=1))
    held_joints = [standing.held(link, number) for number, link in links if link.kind not in FORCE_KINDS]
    return standing.mechanism(held_joints, [(link, number) for number, link in links if link.kind in FORCE_KINDS])


@dataclass(frozen=True, eq=False)
class Held:
    """A joint with its rows (rows, 3 bodies) at the start."""

    joint: Joint
    rows: Array


class Standing:
    """The bodies of a recipe at their start poses, and the construction of joints and forces between them."""

    def __init__(self, recipe: Recipe) -> None:
        self._recipe = recipe
        self._length, mass, self._time = (Decimal(1).scaleb(decade) for decade in recipe.decades)
        self.bodies: list[Body] = []
        self._places, self._sizes = [(Decimal(0), Decimal(0))], [Decimal(0)]  # index 0 is the ground
        for index, part in enumerate(recipe.parts, start=1):
            if not 0 <= part.parent < index:
                raise InvalidMechanism(
                    f"recipe: body {index} has the parent {part.parent}; it must be from 0 to {index - 1}"
                )
            size, weight = ladder(part.size) * self._length, ladder(part.mass) * mass
            x, y = place = _beside(self._places[part.parent], part.offset, size)
            inertia = weight * (ladder(part.gyration) * size) ** 2
            pose = (float(x), float(y), float(part.angle * ANGLE_UNIT))
            self.bodies.append(Body(f"body {index}", float(weight), float(inertia), pose))
            self._places.append(place)
            self._sizes.append(size)

    def _check(self, link: RecipeLink, number: int) -> None:
        count = len(self.bodies)
        if not (0 <= link.first <= count and 0 < link.second <= count and link.first != link.second):
            raise InvalidMechanism(
                f"recipe: joint {number} is between bodies {link.first} and {link.second}; the first must be from 0 "
                f"to {count}, the second from 1, and they must differ"
            )
        if link.kind not in (*ALL_KINDS, *SINGULAR_KINDS) or (link.kind == "roll" and len(link.rims) != 2):
            raise InvalidMechanism(
                f"recipe: joint {number} is a {link.kind!r} of {len(link.rims)} rims; it must be one of "
                f"{', '.join(ALL_KINDS)}, a roll with two rims"
            )

    def _joint(self, link: RecipeLink, number: int) -> Joint:
        self._check(link, number)
        size, name, ends = self._sizes[link.second], f"{link.kind} {number}", self._ends(link)
        (first, second), (first_angle, second_angle) = self._points(link), self._angles(link)
        direction, along = float(link.turn * ANGLE_UNIT), float(link.more * size / 10)
        match link.kind:
            case "pin":
                return Pin(name, *ends, first, second)
            case "slot":
                line = direction - first_angle
                through = (first[0] + along * math.cos(line), first[1] + along * math.sin(line))
                return Slot(name, *ends, through, line, second)
            case "skate":
                return Skate(name, *ends, second, direction - second_angle)
            case "drive":
                return Drive(name, *ends, float(link.more * RATE_UNIT / self._time), second_angle - first_angle)
            case "roll":
                ground, ground_arc = _touching(link.rims[0], size, first, direction - first_angle)
                curve, arc = _touching(link.rims[1], size, second, direction + math.pi - second_angle)
                return Roll(name, *ends, Rolling(curve, ground, second_angle - first_angle, ground_arc, arc))
            case "rod":
                return Rod(name, *ends, self._far_point(link), second, abs(along))
            case "toggle":
                miss, line = float(size.scaleb(-link.strength)), direction - second_angle
                second = (
                    second[0] - along / 2 * math.cos(line) - miss * math.sin(line),
                    second[1] - along / 2 * math.sin(line) + miss * math.cos(line),
                )
                return Rod(name, *ends, self._far_point(link), second, math.hypot(1.5 * along, miss))
            case "fold":
                return self._fold(link, number)
            case "gear":
                ratio = float(link.more * RATE_UNIT)
                return Gear(name, *ends, ratio, second_angle - ratio * first_angle)
            case "weld":
                return Weld(name, *ends, first, second, second_angle - first_angle)
            case _:
                raise InvalidMechanism(f"recipe: joint {number} is a {link.kind}, which has no construction here")

    def _fold(self, link: RecipeLink, number: int) -> Rod:
        """A rod nearly parallel to the line through two pins of the ground."""
        pin, other = self._at(link), _beside(self._places[link.first], link.far, self._sizes[link.first])
        across, up = float(other[0] - pin[0]), float(other[1] - pin[1])
        if not math.hypot(across, up) > 0:
            raise InvalidMechanism(f"recipe: joint {number} is a fold whose two pins are at one place")
        beyond, miss = link.more / 10, 10.0**-link.strength
        end_share = beyond * (1 + link.rest / 10)
        first_point = self._moved(link.first, other, beyond * across, beyond * up)
        second_point = self._moved(link.second, pin, end_share * across - miss * up, end_share * up + miss * across)
        length = math.hypot(across, up) * math.hypot(1 + beyond - end_share, miss)
        return Rod(f"{link.kind} {number}", *self._ends(link), first_point, second_point, length)

    def _force(self, link: RecipeLink, number: int) -> ForceElement:
        """The force element of a link. The strength is in units of the second body's mass, inertia and size."""
        self._check(link, number)
        body, name, ends = self.bodies[link.second - 1], f"{link.kind} {number}", self._ends(link)
        strength, rate = float(ladder(link.strength)), 1 / float(self._time)
        size, (first_angle, second_angle) = self._sizes[link.second], self._angles(link)
        second = self._points(link)[1]
        match link.kind:
            case "spring":
                rest = abs(float(link.more * size / 10)) * (1 + link.rest / 10)
                return Spring(name, *ends, self._far_point(link), second, strength * body.mass * rate**2, rest)
            case "damper":
                return Damper(name, *ends, self._far_point(link), second, strength * body.mass * rate)
            case "torsion-spring":
                rest = second_angle - first_angle + float(link.rest * ANGLE_UNIT)
                return TorsionSpring(name, *ends, strength * body.inertia * rate**2, rest)
            case "torsion-damper":
                return TorsionDamper(name, *ends, strength * body.inertia * rate)
            case "torque":
                return Torque(name, *ends, float(link.more * RATE_UNIT) * body.inertia * rate**2)
            case "force":
                pull = float(link.more * RATE_UNIT * size) * body.mass * rate**2
                direction = float(link.turn * ANGLE_UNIT)
                return Force(name, body.name, second, (pull * math.cos(direction), pull * math.sin(direction)))
            case _:
                raise InvalidMechanism(f"recipe: force {number} is a {link.kind}, which has no construction here")

    def _ends(self, link: RecipeLink) -> tuple[str | None, str]:
        return self.bodies[link.first - 1].name if link.first else None, self.bodies[link.second - 1].name

    def _at(self, link: RecipeLink) -> Point:
        return _beside(self._places[link.second], link.at, self._sizes[link.second])

    def _points(self, link: RecipeLink) -> tuple[Vector, Vector]:
        at = self._at(link)
        return self._local(link.first, at), self._local(link.second, at)

    def _far_point(self, link: RecipeLink) -> Vector:
        """The point [m] on the first body at the distance `more` in the direction `turn` from the link's position."""
        x, y = self._local(link.first, self._at(link))
        along = float(link.more * self._sizes[link.second] / 10)
        line = float(link.turn * ANGLE_UNIT) - self._angles(link)[0]
        return x + along * math.cos(line), y + along * math.sin(line)

    def _moved(self, body: int, place: Point, x: float, y: float) -> Vector:
        """The point `place` + (x, y) [m] of the world, in a body's frame."""
        local_x, local_y = self._local(body, place)
        more_x, more_y = components(-self._angle(body), x, y)
        return local_x + more_x, local_y + more_y

    def _angles(self, link: RecipeLink) -> tuple[float, float]:
        return self._angle(link.first), self._angle(link.second)

    def _angle(self, body: int) -> float:
        return self.bodies[body - 1].pose[2] if body else 0.0

    def _local(self, body: int, point: Point) -> Vector:
        x, y = (float(point[axis] - self._places[body][axis]) for axis in (0, 1))
        return tuple(components(-self._angle(body), x, y))

    def held(self, link: RecipeLink, number: int) -> Held:
        """The joint of a link, with `number` in its name. Raises InvalidMechanism for an invalid link."""
        joint = self._joint(link, number)
        poses = [np.array(self.bodies[body - 1].pose) if body else np.zeros(3) for body in (link.first, link.second)]
        assert not isinstance(joint, Coupling), "a link joins two bodies"
        block = joint.rows(*poses)
        rows = np.zeros((len(block), 3 * len(self.bodies)))
        for body, part in ((link.first, block[:, :3]), (link.second, block[:, 3:])):
            if body:
                rows[:, 3 * body - 3 : 3 * body] += part
        return Held(joint, rows)

    def mechanism(self, held: Sequence[Held], forces: Sequence[tuple[RecipeLink, int]] = ()) -> Mechanism:
        joints = tuple(closed.joint for closed in held)
        twists = self.allowed(held).tolist()
        bodies = tuple(replace(body, twist=tuple(twist)) for body, twist in zip(self.bodies, twists, strict=True))
        down_x, down_y = (float(pull * self._length / self._time**2) for pull in self._recipe.gravity)
        acting = tuple(self._force(link, number) for link, number in forces)
        return Mechanism(bodies, joints, (down_x, down_y), acting)

    def independent(self, held: Sequence[Held]) -> bool:
        if not held:
            return True
        scaled, norm, _ = self._scaled(held)
        if not np.all(norm > 0) or len(norm) > scaled.shape[1]:
            return False
        least = (
            SINGULAR_LIMIT if any(closed.joint.name.startswith(SINGULAR_KINDS) for closed in held) else DEPENDENCE_LIMIT
        )
        return dependence(scaled) >= least

    def _scaled(self, held: Sequence[Held]) -> tuple[Array, Array, Array]:
        """The scaled rows, their norms (rows, 1), and the scales of the coordinates, which are 1 or the length scale
        [m]."""
        turn = np.tile([1.0, 1.0, length_scale(self.bodies, [closed.joint for closed in held])], len(self.bodies))
        scaled = np.vstack([closed.rows for closed in held]) / turn
        return scaled, np.linalg.norm(scaled, axis=1, keepdims=True), turn

    def allowed(self, held: Sequence[Held]) -> Array:
        """The velocities (bodies, 3) that satisfy all joints and are nearest to the recipe's velocities."""
        wanted = np.array([part.velocity for part in self._recipe.parts], dtype=float) * float(RATE_UNIT / self._time)
        wanted[:, :2] *= float(self._length)
        if not self.independent(held):
            raise InvalidMechanism("recipe: the joints' rows are nearly dependent, or one row is zero; remove a joint")
        rate = np.array([value for closed in held for value in closed.joint.rate], dtype=float)
        if not held or not (np.any(wanted) or np.any(rate)):
            return wanted
        scaled, norm, turn = self._scaled(held)
        inverse = np.linalg.pinv(scaled / norm)
        twist = wanted.reshape(-1) * turn
        for _ in range(2):  # the second pass corrects the rounding of the first
            twist = twist - inverse @ ((scaled @ twist - rate) / norm[:, 0])
        if np.abs(twist).max() <= MOTION_ROUNDING * np.abs(wanted.reshape(-1) * turn).max():
            twist = np.zeros_like(twist)
        return (twist / turn).reshape(-1, 3)


def dependence(rows: Array) -> float:
    """The ratio of the smallest to the largest singular value of the normalised rows."""
    sizes = np.linalg.svd(rows / np.linalg.norm(rows, axis=1, keepdims=True), compute_uv=False)
    return float(sizes[-1] / sizes[0])


def _beside(place: Point, tenths: tuple[int, int], size: Decimal) -> Point:
    return place[0] + tenths[0] * size / 10, place[1] + tenths[1] * size / 10


def _touching(rim: Rim, unit: Decimal, point: Vector, tangent: float) -> tuple[Curve, float]:
    """A curve through `point` with the direction `tangent` [rad] in the body's frame, and the arc at this point [m]."""
    size = float(ladder(rim.size) * unit)
    match rim.shape:
        case "line":
            return Line(tangent, point), 0.0
        case "circle" | "ring":
            sense = 1.0 if rim.shape == "circle" else -1.0
            polar = tangent - sense * math.pi / 2
            centre = (point[0] - size * math.cos(polar), point[1] - size * math.sin(polar))
            return (Circle if sense > 0 else Ring)(size, centre), sense * size * polar
        case "ellipse":
            curve = Ellipse(size, float(ladder(rim.size) * ladder(rim.ratio) * unit))
            parameter = np.asarray(float(rim.place * ANGLE_UNIT))
            turn = tangent - float(curve.angle_of(parameter))
            x, y = (point - rotated(np.asarray(turn), curve.point_of(parameter))).tolist()
            return Placed(curve, (x, y), turn), float(curve.arc_of(parameter))
        case _:
            raise InvalidMechanism(f"recipe: a rim is a {rim.shape!r}; it must be one of {', '.join(RIM_SHAPES)}")
