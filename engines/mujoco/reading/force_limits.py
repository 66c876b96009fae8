"""Limits of the forces of actuators: which of them an ideal spring or push lacks, and when one is reached."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import copy
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.frame import name_of

ACTUATOR, JOINT, TENDON = mujoco.mjtObj.mjOBJ_ACTUATOR, mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_TENDON


def limited_servos(model: Any) -> NDArray[np.bool_]:
    """Actuators (nu,) with a limit whose force is not constant; a constant one is read with its limit."""
    affine = model.actuator_biastype == int(mujoco.mjtBias.mjBIAS_AFFINE)
    return model.actuator_forcelimited.astype(bool) & affine & np.any(model.actuator_biasprm[:, 1:3], axis=1)


def limited_forces(model: Any) -> list[str]:
    """The elements whose limit of a force no ideal mechanism has."""
    found = ((ACTUATOR, limited_servos(model)), (JOINT, model.jnt_actfrclimited), (TENDON, model.tendon_actfrclimited))
    return [name_of(model, kind, index) for kind, which in found for index in np.flatnonzero(which)]


def unlimited(model: Any) -> Any:
    """A copy in which none of these limits acts."""
    free = copy.copy(model)
    free.actuator_forcelimited[limited_servos(model)] = 0
    free.jnt_actfrclimited[:] = 0
    free.tendon_actfrclimited[:] = 0
    return free


def reached(model: Any, free: Any, data: Any) -> list[str]:
    """What is at a limit of its force in the state of `data`, after mj_fwdPosition; `free`: see `unlimited`."""
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(free, data)
    wanted, asked = data.actuator_force.copy(), data.qfrc_actuator.copy()
    mujoco.mj_fwdActuation(model, data)
    if np.any(wanted != data.actuator_force):
        return [name_of(model, ACTUATOR, index) for index in np.flatnonzero(wanted != data.actuator_force)]
    return [name_of(model, JOINT, model.dof_jntid[dof]) for dof in np.flatnonzero(asked != data.qfrc_actuator)]
