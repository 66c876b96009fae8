"""Explicit Runge-Kutta methods as numbers: the classical one, and Dormand and Prince's of order 8 as scipy has it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import DOP853

Array = NDArray[np.float64]


class Tableau(NamedTuple):
    """Stages (n, n), weights (n,) and nodes (n,)."""

    stages: Array
    weights: Array
    nodes: Array


NONE = Tableau(np.zeros((0, 0)), np.zeros(0), np.zeros(0))  # of the semi-implicit Euler method
MIDPOINT = Tableau(np.array([[0, 0], [0.5, 0]]), np.array([0.0, 1.0]), np.array([0, 0.5]))
RK4 = Tableau(
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]]),
    np.array([1, 2, 2, 1]) / 6,
    np.array([0, 0.5, 0.5, 1]),
)
FIXED_DOP853 = Tableau(DOP853.A.copy(), DOP853.B.copy(), DOP853.C.copy())


class Embedded(NamedTuple):
    """DOP853 with its error estimates and its dense output: Hairer, Norsett and Wanner, part I, section II.6.

    The thirteenth stage stands at the end of the step, the last three are for dense output alone.
    """

    stages: Array  # (16, 16)
    weights: Array  # (12,)
    nodes: Array  # (16,)
    third: Array  # (13,) error estimates of order 3 and 5
    fifth: Array  # (13,)
    dense: Array  # (4, 16)


def _embedded() -> Embedded:
    extra, own = DOP853.A_EXTRA, DOP853.A
    stages = np.zeros((16, 16))
    stages[:12, :12], stages[12, :12], stages[13:, :] = own, DOP853.B, extra
    nodes = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
    return Embedded(stages, DOP853.B.copy(), nodes, DOP853.E3.copy(), DOP853.E5.copy(), DOP853.D.copy())


ADAPTIVE_DOP853 = _embedded()
