"""A mechanism written in small whole numbers, so that it can be drawn, stored and made smaller, and what it describes.

Bodies stand anywhere; a joint is then put at a place of the world, and the points of its bodies are those that are
there now. So every joint is closed from the beginning, whatever the numbers are, and no loop has to be solved.
Velocities are the nearest ones to those written that the joints allow.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.body import Body, Triple
from reference.curves import Circle, Curve, Ellipse, Line, Placed, Ring
from reference.joints import Drive, Joint, Pin, Skate, Slot, Vector
from reference.mechanism import Mechanism
from reference.plane import components, rotated
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scales import length_scale
from reference.validation import InvalidMechanism

Array = NDArray[np.float64]
KINDS = ("pin", "slot", "skate", "roll", "drive")
SHAPES = ("line", "circle", "ring", "ellipse")

ANGLE = Decimal("0.3")  # rad: no multiple of it but 0 is an angle that a formula is simple at
RATE = Decimal("0.5")  # m/s, and rad/s
# Rows of which a combination is smaller than this, beside the largest, are left out: their forces, and what becomes of
# the motion, depend on digits that no engine keeps.
LEAST_RANK = 1e-3
NO_MOTION = 1e-12  # of the velocities wanted: what rounding leaves where joints allow no motion at all


@dataclass(frozen=True)
class Part:
    """A body. `parent`: 0 is the ground, 1 the first body, and so on; it is earlier than the body itself.

    `offset`: from the parent's place, in tenths of the body's own `size`; `angle` in steps of 0.3 rad; `velocity` in
    steps of 0.5 m/s and rad/s. `size`, `mass` and `gyration` (a share of the size) are steps on the ladder ..., 0.5,
    1, 2, 5, 10, ...
    """

    parent: int = 0
    offset: tuple[int, int] = (0, 0)
    angle: int = 0
    size: int = 0
    mass: int = 0
    gyration: int = 0
    velocity: tuple[int, int, int] = (0, 0, 0)


@dataclass(frozen=True)
class Rim:
    """A curve that rolls: its `shape`; its `size` on the ladder, times that of the second body; and for an ellipse the
    `ratio` of its axes on the ladder, and where it touches, `place` in steps of 0.3 rad of its natural parameter.
    """

    shape: str = "circle"
    size: int = 0
    ratio: int = 0
    place: int = 0


@dataclass(frozen=True)
class Link:
    """A joint of the bodies `first` (0: the ground) and `second`, at `at`: tenths of the second body's size from it.

    `turn`, in steps of 0.3 rad: the direction in the world of a slot, a blade, or the tangent of a contact, with the
    first body's material on its left. `more`: how far the slot's own point lies from there along it (tenths of the
    size), or the rate of a drive in steps of 0.5 rad/s. `rims`: the curves of the first and the second body of a roll.
    """

    kind: str
    first: int
    second: int
    at: tuple[int, int] = (0, 0)
    turn: int = 0
    more: int = 0
    rims: tuple[Rim, ...] = ()


@dataclass(frozen=True)
class Recipe:
    """`gravity` in m/s^2; `decades` of the units of length, mass and time in which everything is written."""

    parts: tuple[Part, ...]
    links: tuple[Link, ...]
    gravity: tuple[int, int] = (0, 0)
    decades: tuple[int, int, int] = (0, 0, 0)

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its joints, each once, in the order of KINDS."""
        return tuple(kind for kind in KINDS if any(link.kind == kind for link in self.links))


def ladder(step: int) -> Decimal:
    """..., 0.2, 0.5, 1, 2, 5, 10, ... with 1 at step 0."""
    return Decimal((1, 2, 5)[step % 3]).scaleb(step // 3)


def build(recipe: Recipe) -> Mechanism:
    """The mechanism of a recipe, which fulfils its joints.

    Raises InvalidMechanism for a recipe that is none: a joint of a body with itself, rows that are nearly dependent,
    curves that don't fit.
    """
    standing = Standing(recipe)
    held = [standing.held(link, number) for number, link in enumerate(recipe.links, start=1)]
    return standing.mechanism(held)


@dataclass(frozen=True, eq=False)
class Held:
    """A joint, and its rows (rows, 3 bodies) in the poses at the start."""

    joint: Joint
    rows: Array


class Standing:
    """The bodies of a recipe in their places, before the joints are chosen and before anything moves."""

    def __init__(self, recipe: Recipe) -> None:
        self._recipe = recipe
        self._length, mass, self._time = (Decimal(1).scaleb(decade) for decade in recipe.decades)
        self.bodies: list[Body] = []
        self._places = [(Decimal(0), Decimal(0))]
        for index, part in enumerate(recipe.parts, start=1):
            if not 0 <= part.parent < index:
                raise InvalidMechanism(
                    f"recipe: body {index} has the parent {part.parent}; it must be from 0 to {index - 1}"
                )
            size, weight = ladder(part.size) * self._length, ladder(part.mass) * mass
            self._places.append(_beside(self._places[part.parent], part.offset, size))
            x, y = self._places[-1]
            inertia = weight * (ladder(part.gyration) * size) ** 2
            pose = (float(x), float(y), float(part.angle * ANGLE))
            self.bodies.append(Body(f"body {index}", float(weight), float(inertia), pose))

    def held(self, link: Link, number: int) -> Held:
        """The joint of a link, `number` being the joint's own. Raises InvalidMechanism for one that can't be."""
        joint = self._joint(link, number)
        poses = [np.array(self.bodies[body - 1].pose) if body else np.zeros(3) for body in (link.first, link.second)]
        block = joint.rows(*poses)
        rows = np.zeros((len(block), 3 * len(self.bodies)))
        for body, part in ((link.first, block[:, :3]), (link.second, block[:, 3:])):
            if body:
                rows[:, 3 * body - 3 : 3 * body] += part
        return Held(joint, rows)

    def mechanism(self, held: Sequence[Held]) -> Mechanism:
        """The mechanism with these joints, moving as they allow."""
        joints = tuple(each.joint for each in held)
        twists = self.allowed(held).tolist()
        bodies = tuple(_with(body, twist=_three(own)) for body, own in zip(self.bodies, twists, strict=True))
        down_x, down_y = (float(pull * self._length / self._time**2) for pull in self._recipe.gravity)
        return Mechanism(bodies, joints, (down_x, down_y))

    def independent(self, held: Sequence[Held]) -> bool:
        """Whether no row can be nearly told from the others, whatever the unit of length."""
        if not held:
            return True
        scaled, norm, _ = self._scaled(held)
        if not np.all(norm > 0) or len(norm) > scaled.shape[1]:
            return False
        sizes = np.linalg.svd(scaled / norm, compute_uv=False)
        return bool(sizes[-1] >= LEAST_RANK * sizes[0])

    def _scaled(self, held: Sequence[Held]) -> tuple[Array, Array, Array]:
        """Rows with angles as arcs, their lengths (rows, 1), and how long the arc of a radian is, by coordinate [m]."""
        turn = np.tile([1.0, 1.0, length_scale(self.bodies, [each.joint for each in held])], len(self.bodies))
        scaled = np.vstack([each.rows for each in held]) / turn
        return scaled, np.linalg.norm(scaled, axis=1, keepdims=True), turn

    def allowed(self, held: Sequence[Held]) -> Array:
        """The velocities (bodies, 3) nearest to those of the recipe with which every joint holds."""
        wanted = np.array([part.velocity for part in self._recipe.parts], dtype=float) * float(RATE / self._time)
        wanted[:, :2] *= float(self._length)
        if not self.independent(held):
            raise InvalidMechanism("recipe: the joints' rows are nearly dependent, or one holds nothing; leave one out")
        rate = np.array([value for each in held for value in each.joint.rate], dtype=float)
        if not held or not (np.any(wanted) or np.any(rate)):
            return wanted
        scaled, norm, turn = self._scaled(held)
        inverse = np.linalg.pinv(scaled / norm)
        twist = wanted.reshape(-1) * turn
        for _ in range(2):  # the second time for the rounding of the first
            twist = twist - inverse @ ((scaled @ twist - rate) / norm[:, 0])
        if np.abs(twist).max() <= NO_MOTION * np.abs(wanted.reshape(-1) * turn).max():
            twist = np.zeros_like(twist)
        return (twist / turn).reshape(-1, 3)

    def _joint(self, link: Link, number: int) -> Joint:
        count = len(self.bodies)
        if not (0 <= link.first <= count and 0 < link.second <= count and link.first != link.second):
            raise InvalidMechanism(
                f"recipe: joint {number} is between bodies {link.first} and {link.second}; the first must be from 0 "
                f"to {count}, the second from 1, and they must differ"
            )
        size = ladder(self._recipe.parts[link.second - 1].size) * self._length
        at = _beside(self._places[link.second], link.at, size)
        name = f"{link.kind} {number}"
        ends = (self.bodies[link.first - 1].name if link.first else None, self.bodies[link.second - 1].name)
        first, second = self._own(link.first, at), self._own(link.second, at)
        first_angle, second_angle = self._angle(link.first), self._angle(link.second)
        direction = float(link.turn * ANGLE)
        match link.kind:
            case "pin":
                return Pin(name, *ends, first, second)
            case "slot":
                along, line = float(link.more * size / 10), direction - first_angle
                through = (first[0] + along * math.cos(line), first[1] + along * math.sin(line))
                return Slot(name, *ends, through, line, second)
            case "skate":
                return Skate(name, *ends, second, direction - second_angle)
            case "drive":
                return Drive(name, *ends, float(link.more * RATE / self._time), second_angle - first_angle)
            case "roll" if len(link.rims) == 2:
                ground, ground_arc = _touching(link.rims[0], size, first, direction - first_angle)
                curve, arc = _touching(link.rims[1], size, second, direction + math.pi - second_angle)
                return Roll(name, *ends, Rolling(curve, ground, second_angle - first_angle, ground_arc, arc))
        raise InvalidMechanism(
            f"recipe: joint {number} is a {link.kind!r} of {len(link.rims)} rims; it must be one of {', '.join(KINDS)}"
            ", a roll with two rims"
        )

    def _angle(self, body: int) -> float:
        return self.bodies[body - 1].pose[2] if body else 0.0

    def _own(self, body: int, point: tuple[Decimal, Decimal]) -> Vector:
        """A point of the world in a body's frame."""
        x, y = (float(point[axis] - self._places[body][axis]) for axis in (0, 1))
        return tuple(components(-self._angle(body), x, y))


def _beside(place: tuple[Decimal, Decimal], tenths: tuple[int, int], size: Decimal) -> tuple[Decimal, Decimal]:
    return place[0] + tenths[0] * size / 10, place[1] + tenths[1] * size / 10


def _with(value: Any, **changed: Any) -> Any:
    """As dataclasses.replace, for what has fields that its own class computes."""
    own = {field.name: getattr(value, field.name) for field in fields(value)}
    return type(value)(**(own | changed))


def _three(values: Any) -> Triple:
    x, y, angle = values
    return x, y, angle


def _touching(rim: Rim, unit: Decimal, point: Vector, tangent: float) -> tuple[Curve, float]:
    """The curve through `point` in the direction `tangent` [rad], both in its body's frame, and its arc there [m]."""
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
            parameter = np.asarray(float(rim.place * ANGLE))
            turn = tangent - float(curve.angle_of(parameter))
            x, y = (point - rotated(np.asarray(turn), curve.point_of(parameter))).tolist()
            return Placed(curve, (x, y), turn), float(curve.arc_of(parameter))
    raise InvalidMechanism(f"recipe: a rim is a {rim.shape!r}; it must be one of {', '.join(SHAPES)}")


def as_text(recipe: Recipe) -> str:
    """JSON, with what is as usual left out."""

    def short(value: Any) -> dict[str, Any]:
        usual = {field.name: field.default for field in fields(value)}
        own = {name: getattr(value, name) for name in usual if name not in ("parts", "links", "rims")}
        return {name: each for name, each in own.items() if each != usual[name]}

    def linked(link: Link) -> dict[str, Any]:
        return short(link) | ({"rims": [short(rim) for rim in link.rims]} if link.rims else {})

    parts, links = [short(part) for part in recipe.parts], [linked(link) for link in recipe.links]
    return json.dumps({**short(recipe), "parts": parts, "links": links}, sort_keys=True)


def from_text(text: str) -> Recipe:
    """The recipe that `as_text` wrote. Raises ValueError for text that is none."""
    try:
        told = json.loads(text)
        parts = tuple(Part(**{k: _frozen(v) for k, v in part.items()}) for part in told.pop("parts"))
        links = []
        for link in told.pop("links"):
            rims = tuple(Rim(**rim) for rim in link.pop("rims", ()))
            links.append(Link(**{k: _frozen(v) for k, v in link.items()}, rims=rims))
        return Recipe(parts, tuple(links), **{k: _frozen(v) for k, v in told.items()})
    except (TypeError, KeyError, AttributeError) as error:
        raise ValueError(f"recipe: this is no recipe ({error}); it must be what `as_text` writes") from None


def _frozen(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value
