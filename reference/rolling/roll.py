"""The joint Roll: a curve of the second body rolls without slip on a curve of the first body or the ground."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.elements import BetweenTwo, JointElement
from reference.plane import components, rotation_velocity
from reference.rolling.contact import Contact
from reference.rolling.curves import Vector
from reference.rolling.kinematics import Rolling


@dataclass(frozen=True)
class Roll(BetweenTwo, JointElement):
    """Ideal rolling of two bodies (18.66): both bodies have the same velocity at the contact.

    `rolling` has two curves and their contact at the start. `ground` is in the frame of the first body or the world,
    and `body` is in the frame of the second body, both from the centre of mass. The contact is a function of the
    relative rotation alone, so the joint is holonomic.

    Rows: relative velocity at the contact along e_t, then along e_n. The direction e_t is the one in which `ground` is
    traversed, and e_n points into the second body (see `reference.rolling.curves`). If the gap is zero, the rows are
    the derivatives of the gap. Reactions on the second body [N]: friction along e_t, and the normal force along e_n,
    which is negative if the joint pulls.
    """

    size: ClassVar[int] = 2
    labels: ClassVar[tuple[str, ...]] = ("tangent", "normal")
    stackable: ClassVar[bool] = False  # curves can't be stacked in an array

    rolling: Rolling

    @property
    def fallback_lengths(self) -> tuple[float, ...]:
        """The radii of curvature of both curves [m] at the contact at the start."""
        sides = ((self.rolling.ground, self.rolling.ground_arc), (self.rolling.body, self.rolling.body_arc))
        curvatures = [abs(float(curve.curvature(arc))) for curve, arc in sides]
        return tuple(1 / curvature for curvature in curvatures if curvature)

    @cached_property
    def first_point(self) -> Vector:
        """The contact at the start, in the first body's frame [m]."""
        x, y = self.rolling.ground.point(self.rolling.ground_arc)
        return (float(x), float(y))

    @cached_property
    def second_point(self) -> Vector:
        x, y = self.rolling.body.point(self.rolling.body_arc)
        return (float(x), float(y))

    def _contact(self, theta: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Contact point, arm r_{O'/C} (..., 2) and tangent angle (...), in the first body's frame.

        The imaginary part of a rotation is multiplied by the first derivative, which is exact for a complex step.
        """
        contact = self._contact_at(np.real(theta))
        if not np.iscomplexobj(theta):
            return contact.point, contact.arm, contact.tangent_angle
        step = 1j * np.imag(theta)
        advance = (step * contact.rate)[..., None] * contact.tangent
        angle = contact.tangent_angle + step * contact.ground_curvature * contact.rate
        return contact.point + advance, contact.arm + rotation_velocity(step, contact.arm) - advance, angle

    def _contact_at(self, theta: NDArray[Any]) -> Contact:
        """The contact at rotations (...). The last result is cached, since gap and rows use the same contact."""
        if not (self._last and np.array_equal(self._last[0][0], theta)):
            self._last[:] = [(theta.copy(), self.rolling.contact(theta))]
        return self._last[0][1]

    @cached_property
    def _last(self) -> list[tuple[NDArray[Any], Contact]]:
        return []

    def gap(self, first: NDArray[Any], second: NDArray[Any], t: ArrayLike) -> NDArray[Any]:
        """Displacement of the second body from ideal rolling at the same rotation, along e_t and e_n (..., 2) [m]."""
        point, arm, angle = self._contact(np.asarray(second[..., 2] - first[..., 2]))
        x, y = components(first[..., 2], point[..., 0] + arm[..., 0], point[..., 1] + arm[..., 1])
        open_x, open_y = second[..., 0] - first[..., 0] - x, second[..., 1] - first[..., 1] - y
        along, across = np.cos(angle + first[..., 2]), np.sin(angle + first[..., 2])
        return np.stack([along * open_x + across * open_y, across * open_x - along * open_y], axis=-1)

    def rows(self, first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
        """Velocity rows (..., 2, 6): columns are the first body's x, y, angle and then the second's."""
        point, arm, angle = self._contact(np.asarray(second[..., 2] - first[..., 2]))
        world = angle + first[..., 2]
        rows = np.zeros((*world.shape, 2, 6), dtype=np.result_type(world, point))
        for row, x, y, local_x, local_y in (
            (0, np.cos(world), np.sin(world), np.cos(angle), np.sin(angle)),
            (1, np.sin(world), -np.cos(world), np.sin(angle), -np.cos(angle)),
        ):
            rows[..., row, 0], rows[..., row, 1] = -x, -y
            rows[..., row, 2] = local_x * point[..., 1] - local_y * point[..., 0]
            rows[..., row, 3], rows[..., row, 4] = x, y
            rows[..., row, 5] = local_x * arm[..., 1] - local_y * arm[..., 0]
        return rows
