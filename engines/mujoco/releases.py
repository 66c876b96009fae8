"""Releases of MuJoCo: their known faults, for warnings of every motion, and differences in their interfaces."""

from __future__ import annotations

import re
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from reference.trajectory import RunWarning

KNOWN_WRONG = "known to be wrong"  # in every warning of such a release
UPPER_CASE = ("RK4", "PGS", "CG")  # words of MJCF that are not in lower case
MIXED_CASE = {"EULER": "Euler", "NEWTON": "Newton"}
# The flag that solves all rows in one system. Before 3.3.6 there was none, and islands were off by default.
NO_ISLANDS = int(getattr(mujoco.mjtDisableBit, "mjDSBL_ISLAND", 0))


def known_fault(version: str) -> str:
    """The known fault of a release, one sentence; empty for a release without one.

    Before 3.7: the changelog of 3.7.0. 4.0.0: the changelog of 4.0.1, github.com/google-deepmind/mujoco/issues/3767;
    `tests/engines/test_mujoco_upstream.py` compares the two.
    """
    numbers, reason = tuple(int(part) for part in re.findall(r"\d+", version)[:3]), ""
    if numbers < (3, 7):
        reason = "it leaves the velocity term out of its loop constraints, which 3.7 and later have"
    if numbers == (4, 0, 0):
        reason = "it factorises the Hessian of its Newton solver wrongly where the Jacobian of the constraints is "
        reason += "sparse, for some trees that branch, which 4.0.1 mended"
    return f"MuJoCo {version} is {KNOWN_WRONG}: {reason}" if reason else ""


def full_inertia(compiled: Any, data: Any) -> NDArray[np.float64]:
    """The mass matrix (nv, nv) in the state of `data`; older releases have another signature."""
    dense = np.zeros((compiled.nv, compiled.nv))
    try:
        mujoco.mj_fullM(compiled, data, dense)
    except TypeError:
        mujoco.mj_fullM(compiled, dense, data.qM)
    return dense


def spelled(constant: Any) -> str:
    """A constant of MuJoCo's as MJCF spells it: 'implicitfast' for mjINT_IMPLICITFAST."""
    word = constant.name.split("_")[1]
    return MIXED_CASE.get(word, word if word in UPPER_CASE else word.lower())


def release_warnings() -> list[RunWarning]:
    """The warnings of every motion with the imported release."""
    fault = known_fault(mujoco.__version__)
    return [RunWarning(f"ours: {fault}", "known fault", "adapter")] if fault else []
