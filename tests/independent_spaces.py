"""Motions of pymunk spaces by absolute coordinates, Lagrange multipliers and DOP853, without code of this suite.

Rows of joints are derivatives by complex steps. Parameters are read from the space.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import (
    DampedRotarySpring,
    DampedSpring,
    GearJoint,
    GrooveJoint,
    PinJoint,
    PivotJoint,
    RotaryLimitJoint,
    SimpleMotor,
)
from scipy.integrate import solve_ivp

Array = NDArray[Any]
IMAGINARY_STEP = 1e-30


class Equations:
    """The rows and forces of a space. Coordinates (3 bodies, columns) are x, y and angle of each body."""

    def __init__(self, space: pymunk.Space) -> None:
        self.space, self.bodies = space, list(space.bodies)
        self.places = {body: 3 * number for number, body in enumerate(self.bodies)}
        self.inverse = np.array([1 / value for b in self.bodies for value in (b.mass, b.mass, b.moment)])
        self.start = np.array([value for b in self.bodies for value in (*b.position, b.angle)])
        self.speed = np.array([value for b in self.bodies for value in (*b.velocity, b.angular_velocity)])
        self.weight = np.array([value for b in self.bodies for value in (*(b.mass * space.gravity), 0.0)])
        springs = (DampedSpring, DampedRotarySpring)
        self.springs: list[Any] = [joint for joint in space.constraints if isinstance(joint, springs)]
        self.joints: list[Any] = [joint for joint in space.constraints if not isinstance(joint, springs)]
        self.rates = -np.array(
            [getattr(j, "rate", 0.0) for j in self.joints for _ in self._measured(self.start[:, None], j)]
        )

    def _pose(self, q: Array, body: pymunk.Body) -> Array:
        if body in self.places:
            return q[self.places[body] : self.places[body] + 3]
        return np.array([[body.position.x], [body.position.y], [body.angle]])

    def _point(self, q: Array, body: pymunk.Body, at: Any) -> Array:
        x, y, angle = self._pose(q, body)
        c, s = np.cos(angle), np.sin(angle)
        return np.array([x + c * at[0] - s * at[1], y + s * at[0] + c * at[1]])

    def _between(self, q: Array, joint: Any) -> Array:
        return self._point(q, joint.b, joint.anchor_b) - self._point(q, joint.a, joint.anchor_a)

    def _turned(self, q: Array, joint: Any) -> Array:
        return self._pose(q, joint.b)[2] - self._pose(q, joint.a)[2]

    def _measured(self, q: Array, joint: Any) -> list[Array]:
        match joint:
            case PivotJoint():
                return [*self._between(q, joint)]
            case PinJoint() | DampedSpring():
                return [np.sqrt(np.sum(self._between(q, joint) ** 2, axis=0))]
            case GrooveJoint():
                begin, end = (self._point(q, joint.a, at) for at in (joint.groove_a, joint.groove_b))
                (x, y), (u, v) = end - begin, self._point(q, joint.b, joint.anchor_b) - begin
                return [(x * v - y * u) / (joint.groove_b - joint.groove_a).length]
            case GearJoint():
                return [joint.ratio * self._pose(q, joint.b)[2] - self._pose(q, joint.a)[2]]
            case SimpleMotor() | RotaryLimitJoint() if isinstance(joint, SimpleMotor) or joint.min == joint.max:
                return [self._turned(q, joint)]
            case DampedRotarySpring():
                return [-self._turned(q, joint)]
            case _:
                raise NotImplementedError(joint)

    def _all(self, q: Array, joints: list[Any]) -> Array:
        rows = [row for joint in joints for row in self._measured(q, joint)]
        return np.array([np.broadcast_to(row, q.shape[1:]) for row in rows]).reshape(-1, q.shape[1])

    def _rows(self, q: Array) -> Array:
        return self._all(q, self.joints)

    def _springs(self, q: Array) -> Array:
        return self._all(q, self.springs)

    def _slopes(self, function: Any, q: Array) -> Array:
        return np.imag(function(q[:, None] + IMAGINARY_STEP * 1j * np.eye(q.size))) / IMAGINARY_STEP

    def forces(self, q: Array, speed: Array) -> Array:
        slopes, lengths = self._slopes(self._springs, q), self._springs(q[:, None])[:, 0]
        out = self.weight.copy()
        for joint, slope, length in zip(self.springs, slopes, lengths, strict=True):
            rest = joint.rest_length if isinstance(joint, DampedSpring) else joint.rest_angle
            out -= slope * (joint.stiffness * (length - rest) + joint.damping * (slope @ speed))
        return out

    def _held(self, q: Array, speed: Array, wanted: Array) -> Array:
        """Speeds or accelerations with the smallest mass-weighted change that give the rows the rates `wanted`."""
        root = np.sqrt(self.inverse)
        rows = self._slopes(self._rows, q)
        return speed + root * np.linalg.lstsq(rows * root, wanted - rows @ speed, rcond=1e-11)[0]

    def nearest_speeds(self) -> Array:
        """The nearest speeds that satisfy the joints."""
        return self._held(self.start, self.speed, self.rates)

    def accelerations(self, q: Array, speed: Array) -> Array:
        step = 1e-3 / (np.abs(speed[2::3]).max() + 1e-6)  # 1e-3 rad, so the stencil's error is 1e-12

        def rates(ahead: float) -> Array:
            return np.imag(self._rows((q + (ahead + IMAGINARY_STEP * 1j) * speed)[:, None]))[:, 0] / IMAGINARY_STEP

        bias = (8 * (rates(step) - rates(-step)) - rates(2 * step) + rates(-2 * step)) / (12 * step)
        return self._held(q, self.inverse * self.forces(q, speed), -bias)

    def motion(self, t: Array) -> Array:
        """Poses (times, bodies, 3) from the space's poses and `nearest_speeds`."""
        count = self.start.size
        solution = solve_ivp(
            lambda _, state: np.concatenate([state[count:], self.accelerations(*np.split(state, 2))]),
            (0.0, float(t[-1])),
            np.concatenate([self.start, self.nearest_speeds()]),
            "DOP853",
            t_eval=t,
            rtol=1e-11,
            atol=1e-11,
        )
        return solution.y[:count].T.reshape(len(t), -1, 3)
