"""Derivatives of analytic functions by Cauchy's integral over a circle in the complex plane: exact to rounding."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

CIRCLE_POINTS = 64  # errors fall like (radius / distance to the next singularity)^points


def derivative(position: Callable[[Any], Any], t: float, order: int = 1, radius: float = 0.25) -> NDArray[np.float64]:
    """The derivative (...) of an analytic position at time t [s], from its values on a circle of `radius` [s]."""
    circle = radius * np.exp(2j * math.pi * np.arange(CIRCLE_POINTS) / CIRCLE_POINTS)
    terms = [np.asarray(position(t + z)) / z**order for z in circle]
    return math.factorial(order) * np.mean(terms, axis=0).real
