"""Motions of MuJoCo models by tree coordinates, multipliers and DOP853, without code of the judge."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
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
