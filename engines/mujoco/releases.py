"""Releases of MuJoCo: known faults, about which every run warns, and differences between interfaces."""

from __future__ import annotations

import re
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from reference.trajectory import ADAPTER_PREFIX, KNOWN_WRONG, RunWarning

UPPER_CASE = ("RK4", "PGS", "CG")  # Constants in upper case in MJCF.
MIXED_CASE = {"EULER": "Euler", "NEWTON": "Newton"}
# The flag that makes MuJoCo solve all rows in one system. Before 3.3.6 MuJoCo did so by default and had no flag.
NO_ISLANDS = int(getattr(mujoco.mjtDisableBit, "mjDSBL_ISLAND", 0))


def known_fault(version: str) -> str:
    """A sentence about the known fault of a release, or "" if no fault is known.

    The sources are the changelogs of 3.7.0 and 4.0.1, and github.com/google-deepmind/mujoco/issues/3767.
    """
    numbers, reason = tuple(int(part) for part in re.findall(r"\d+", version)[:3]), ""
    if numbers < (3, 7):
        reason = "it leaves the velocity term out of its loop constraints, which 3.7 and later have"
    if numbers == (4, 0, 0):
        reason = "it factorises the Hessian of its Newton solver wrongly where the Jacobian of the constraints is "
        reason += "sparse, for some trees that branch, which 4.0.1 mended"
    return f"MuJoCo {version} is {KNOWN_WRONG}: {reason}" if reason else ""


def full_inertia(compiled: Any, data: Any) -> NDArray[np.float64]:
    """The mass matrix (nv, nv) in the state of `data`; the signature of mj_fullM depends on the release."""
    dense = np.zeros((compiled.nv, compiled.nv))
    try:
        mujoco.mj_fullM(compiled, data, dense)
    except TypeError:
        mujoco.mj_fullM(compiled, dense, data.qM)
    return dense


def spelled(constant: Any) -> str:
    """The word in MJCF for a constant of MuJoCo, such as 'implicitfast' for mjINT_IMPLICITFAST."""
    word = constant.name.split("_")[1]
    return MIXED_CASE.get(word, word if word in UPPER_CASE else word.lower())


def release_warnings() -> list[RunWarning]:
    fault = known_fault(mujoco.__version__)
    return [RunWarning(f"{ADAPTER_PREFIX} {fault}", "known fault", "adapter")] if fault else []
