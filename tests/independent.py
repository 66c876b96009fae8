"""Motions by multipliers and DOP853 without code of this suite: MuJoCo's in tree, pymunk's in absolute coordinates.

Rows of pymunk's joints are derivatives by complex steps. Parameters are read from the space.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco
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
Rows = Callable[[Any, Any], tuple[Array, Array]]


def connected(name: str | int) -> Rows:
    """Rows of a connect between bodies or sites: the point's velocity on the first minus its velocity on the second."""

    def rows(model: Any, data: Any) -> tuple[Array, Array]:
        equality = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_EQUALITY, name) if isinstance(name, str) else name
        of_sites = model.eq_objtype[equality] == mujoco.mjtObj.mjOBJ_SITE
        out, rates = np.zeros((2, 3, model.nv))
        for thing, part, sign in ((model.eq_obj1id[equality], 0, 1), (model.eq_obj2id[equality], 3, -1)):
            body = model.site_bodyid[thing] if of_sites else thing
            inside = data.xmat[body].reshape(3, 3) @ model.eq_data[equality][part : part + 3]
            at = data.site_xpos[thing] if of_sites else data.xpos[body] + inside
            jac, rate = np.zeros((2, 3, model.nv))
            mujoco.mj_jac(model, data, jac, None, at, body)
            mujoco.mj_jacDot(model, data, rate, None, at, body)
            out, rates = out + sign * jac, rates + sign * rate
        flat = np.abs(out).max(axis=1) > 1e-6 * np.abs(out).max()  # the row normal to the plane is left out
        return out[flat], rates[flat] @ data.qvel

    return rows


def coupled(*factors: float) -> Rows:
    """The velocity row of a linear relation of all coordinates."""
    return lambda model, data: (np.array([factors], dtype=float), np.zeros(1))


def equalities(model: Any) -> list[Rows]:
    """The rows of a model's equalities (connects, and linear ones of joints and tendons), for hinges and slides."""

    def factors(equality: int) -> Array:
        row = np.zeros(model.nv)
        first, second, slope = model.eq_obj1id[equality], model.eq_obj2id[equality], model.eq_data[equality][1]
        assert not model.eq_data[equality][2:5].any()
        for thing, share in ((first, 1.0), (second, -slope)):
            if thing >= 0 and model.eq_type[equality] == mujoco.mjtEq.mjEQ_JOINT:
                row[model.jnt_dofadr[thing]] += share
            elif thing >= 0:
                span = slice(model.tendon_adr[thing], model.tendon_adr[thing] + model.tendon_num[thing])
                for joint, factor in zip(model.wrap_objid[span], model.wrap_prm[span], strict=True):
                    row[model.jnt_dofadr[joint]] += share * factor
        return row

    connects = [kind == mujoco.mjtEq.mjEQ_CONNECT for kind in model.eq_type]
    return [connected(number) if is_point else coupled(*factors(number)) for number, is_point in enumerate(connects)]


def motion(model: Any, data: Any, constraints: list[Rows], t: Array) -> tuple[Array, Array]:
    """Coordinates (times, nv) of a tree with these rows and the rows' forces (times, rows), from the state of `data`.
    MuJoCo computes the mass matrix and the forces of gravity, springs, dampers and actuators.
    """
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)

    def solved(state: Array) -> tuple[Array, Array]:
        data.qpos[:], data.qvel[:] = np.split(state, 2)
        mujoco.mj_forward(model, data)
        mass = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, mass)
        force = data.qfrc_passive + data.qfrc_actuator - data.qfrc_bias
        pairs = [(np.zeros((0, model.nv)), np.zeros(0)), *(rows(model, data) for rows in constraints)]
        matrix, rate = (np.concatenate([pair[i] for pair in pairs]) for i in (0, 1))
        system = np.block([[mass, -matrix.T], [matrix, np.zeros((len(matrix), len(matrix)))]])
        out = np.linalg.solve(system, np.concatenate([force, -rate]))
        return out[: model.nv], out[model.nv :]

    start = np.concatenate([data.qpos, data.qvel])
    solution = solve_ivp(
        lambda _, state: np.concatenate([state[model.nv :], solved(state)[0]]),
        (0.0, float(t[-1])),
        start,
        "DOP853",
        t_eval=t,
        rtol=1e-11,
        atol=1e-12,
    )
    return solution.y[: model.nv].T, np.array([solved(state)[1] for state in solution.y.T], dtype=np.float64)


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
