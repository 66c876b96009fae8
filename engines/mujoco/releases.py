"""Releases of MuJoCo: which are known to move wrongly without a warning, and what older ones name otherwise.

They run like all others, so that they can be compared; every motion of one that is known to be wrong says so.
"""

from __future__ import annotations

import re
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

MARK = "known to be wrong"  # what rows and pages know such a release by
CAPITALS = ("RK4", "PGS", "CG")  # words of MJCF that are not in small letters
MIXED = {"EULER": "Euler", "NEWTON": "Newton"}
# The flag that solves all rows as one. Before 3.3.6 there was none, and islands had to be asked for.
NO_ISLANDS = int(getattr(mujoco.mjtDisableBit, "mjDSBL_ISLAND", 0))


def known_wrong(version: str) -> str:
    """Why the motions of a release can't be trusted, one sentence; empty for all others.

    Before 3.7: the changelog of 3.7.0. 4.0.0: the changelog of 4.0.1, github.com/google-deepmind/mujoco/issues/3767;
    `tests/engines/test_mujoco_upstream.py` compares the two.
    """
    numbers, reason = tuple(int(part) for part in re.findall(r"\d+", version)[:3]), ""
    if numbers < (3, 7):
        reason = "it leaves the velocity term out of its loop constraints, which 3.7 and later have"
    if numbers == (4, 0, 0):
        reason = "it factorises the Hessian of its Newton solver wrongly where the Jacobian of the constraints is "
        reason += "sparse, for some trees that branch, which 4.0.1 mended"
    return f"MuJoCo {version} is {MARK}: {reason}" if reason else ""


def full_inertia(compiled: Any, data: Any) -> NDArray[np.float64]:
    """The mass matrix (nv, nv) in the state of `data`; older releases ask for the sparse one by itself."""
    dense = np.zeros((compiled.nv, compiled.nv))
    try:
        mujoco.mj_fullM(compiled, data, dense)
    except TypeError:
        mujoco.mj_fullM(compiled, dense, data.qM)
    return dense


def spelled(constant: Any) -> str:
    """A constant of MuJoCo's as MJCF spells it: 'implicitfast' for mjINT_IMPLICITFAST."""
    word = constant.name.split("_")[1]
    return MIXED.get(word, word if word in CAPITALS else word.lower())


def marks() -> list[str]:
    """What every motion of the release that is imported has to say of it, as warnings of ours."""
    told = known_wrong(mujoco.__version__)
    return [f"ours: {told}"] if told else []
