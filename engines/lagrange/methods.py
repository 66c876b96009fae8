"""Explicit Runge-Kutta methods as arrays."""

from __future__ import annotations

from importlib.util import find_spec, module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Tableau(NamedTuple):
    """An explicit Runge-Kutta method.

    The weights of error estimates and of dense output are for adaptive steps of DOP853 only (Hairer, Norsett and
    Wanner, part I, section II.6). Stage 13 is at the end of the step, and three further stages are for dense output.
    """

    stages: Array  # (n, n)
    weights: Array  # (n,), or (12,) for adaptive steps
    nodes: Array  # (n,)
    third: Array = np.zeros(0)  # (13,) weights of the error estimate of order 3
    fifth: Array = np.zeros(0)  # (13,) weights of the error estimate of order 5
    dense: Array = np.zeros((0, 0))  # (4, 16)


def _dop853() -> Tableau:
    """The method for adaptive steps, from scipy's file of numbers, since the import of `scipy.integrate` is slow."""
    found = find_spec("scipy")
    file = Path(found.origin if found and found.origin else "").parent / "integrate/_ivp/dop853_coefficients.py"
    spec = spec_from_file_location("dop853_coefficients", file)
    try:
        if spec is None or spec.loader is None:
            raise ImportError(str(file))
        numbers: Any = module_from_spec(spec)
        spec.loader.exec_module(numbers)
    except (ImportError, OSError):  # a release of scipy with other files
        from scipy.integrate._ivp import dop853_coefficients as numbers
    return Tableau(numbers.A, numbers.B, numbers.C, numbers.E3, numbers.E5, numbers.D)


NO_STAGES = Tableau(np.zeros((0, 0)), np.zeros(0), np.zeros(0))  # the semi-implicit Euler method
RK4 = Tableau(
    np.array([[0, 0, 0, 0], [0.5, 0, 0, 0], [0, 0.5, 0, 0], [0, 0, 1, 0]]),
    np.array([1, 2, 2, 1]) / 6,
    np.array([0, 0.5, 0.5, 1]),
)
ADAPTIVE_DOP853 = _dop853()
FIXED_DOP853 = Tableau(ADAPTIVE_DOP853.stages[:12, :12].copy(), ADAPTIVE_DOP853.weights, ADAPTIVE_DOP853.nodes[:12])
