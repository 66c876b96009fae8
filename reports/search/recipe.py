"""The mechanism that a recipe of small whole numbers describes (`reports.search.parts`).

Bodies stand anywhere; a joint is then put at a place of the world, and the points of its bodies are those that are
there now. So every joint is closed from the beginning, whatever the numbers are, and no loop has to be solved.
Velocities are the nearest ones to those written that the joints allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism
from reference.joints import Body, Joint, Triple
from reference.mechanism import Mechanism
from reference.scales import length_scale
from reports.search.joining import Joining, beside
from reports.search.parts import ANGLE, FORCES, RATE, Link, Recipe, ladder

Array = NDArray[np.float64]
# Rows of which a combination is smaller than this, beside the largest, are left out: their forces, and what becomes of
# the motion, depend on digits that no engine keeps.
LEAST_RANK = 1e-3
NO_MOTION = 1e-12  # of the velocities wanted: what rounding leaves where joints allow no motion at all


def build(recipe: Recipe) -> Mechanism:
    """The mechanism of a recipe, which fulfils its joints.

    Raises InvalidMechanism for a recipe that is none: a joint of a body with itself, rows that are nearly dependent,
    curves that don't fit.
    """
    standing = Standing(recipe)
    links = list(enumerate(recipe.links, start=1))
    held = [standing.held(link, number) for number, link in links if link.kind not in FORCES]
    return standing.mechanism(held, [(link, number) for number, link in links if link.kind in FORCES])


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
        places, sizes = [(Decimal(0), Decimal(0))], [Decimal(0)]
        for index, part in enumerate(recipe.parts, start=1):
            if not 0 <= part.parent < index:
                raise InvalidMechanism(
                    f"recipe: body {index} has the parent {part.parent}; it must be from 0 to {index - 1}"
                )
            size, weight = ladder(part.size) * self._length, ladder(part.mass) * mass
            places.append(beside(places[part.parent], part.offset, size))
            sizes.append(size)
            x, y = places[-1]
            inertia = weight * (ladder(part.gyration) * size) ** 2
            pose = (float(x), float(y), float(part.angle * ANGLE))
            self.bodies.append(Body(f"body {index}", float(weight), float(inertia), pose))
        self.joining = Joining(self.bodies, places, sizes, self._time)

    def held(self, link: Link, number: int) -> Held:
        """The joint of a link, `number` being the joint's own. Raises InvalidMechanism for one that can't be."""
        joint = self.joining.joint(link, number)
        poses = [np.array(self.bodies[body - 1].pose) if body else np.zeros(3) for body in (link.first, link.second)]
        block = joint.rows(*poses)
        rows = np.zeros((len(block), 3 * len(self.bodies)))
        for body, part in ((link.first, block[:, :3]), (link.second, block[:, 3:])):
            if body:
                rows[:, 3 * body - 3 : 3 * body] += part
        return Held(joint, rows)

    def mechanism(self, held: Sequence[Held], forces: Sequence[tuple[Link, int]] = ()) -> Mechanism:
        """The mechanism with these joints and forces, moving as the joints allow."""
        joints = tuple(each.joint for each in held)
        twists = self.allowed(held).tolist()
        bodies = tuple(_with(body, twist=_three(own)) for body, own in zip(self.bodies, twists, strict=True))
        down_x, down_y = (float(pull * self._length / self._time**2) for pull in self._recipe.gravity)
        acting = tuple(self.joining.force(link, number) for link, number in forces)
        return Mechanism(bodies, joints, (down_x, down_y), acting)

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


def _with(value: Any, **changed: Any) -> Any:
    """As dataclasses.replace, for what has fields that its own class computes."""
    own = {field.name: getattr(value, field.name) for field in fields(value)}
    return type(value)(**(own | changed))


def _three(values: Any) -> Triple:
    x, y, angle = values
    return x, y, angle
