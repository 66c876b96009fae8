"""The integral of a function of time, accurate to rounding, and the derivative of an analytic function.

Integrals are sums over adaptive panels with Chebyshev series. Derivatives are Cauchy integrals over a complex circle.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.validators import Array

# Number of points of a panel, which resolve one radian of an oscillation to rounding.
PANEL_POINTS = 24
# Number of the last coefficients of a panel's series that must be zero to rounding; otherwise the panel is halved.
TAIL = 4
# Maximum number of halvings of a panel around a jump of the integrand. The panel is then shorter than rounding.
MOST_HALVINGS = 46

# Chebyshev points of the first kind. The matrix (coefficients, points) converts values at these points to the series.
_GAUSS_POINTS = np.cos(np.pi * (np.arange(PANEL_POINTS) + 0.5) / PANEL_POINTS)
_TO_COEFFICIENTS = (2.0 / PANEL_POINTS) * np.cos(
    np.outer(np.arange(PANEL_POINTS), np.pi * (np.arange(PANEL_POINTS) + 0.5) / PANEL_POINTS)
)
_TO_COEFFICIENTS[0] /= 2
_INTEGRATE = np.polynomial.chebyshev.chebint(np.eye(PANEL_POINTS), lbnd=-1)


def _series_at(series: NDArray[Any], place: Array) -> NDArray[Any]:
    """The values (times,) of Chebyshev series (times, terms) at places (times,) by Clenshaw's recurrence."""
    later, latest = np.zeros_like(series[:, 0]), np.zeros_like(series[:, 0])
    for term in range(series.shape[1] - 1, 0, -1):
        later, latest = series[:, term] + 2 * place * later - latest, later
    return series[:, 0] + place * later - latest


# This limits the points to 40 MB; scenes of this suite have at most a few hundred panels.
MOST_PANELS = 100_000


class Antiderivative:
    """The integral of f from 0 to t, for a real or complex f; panels are added when a later time is needed.

    `panel` [s] is the length of the longest panel. Choose about the shortest time scale of f, so that the points of a
    panel resolve f.
    """

    def __init__(self, function: Callable[[Array], NDArray[Any]], panel: float) -> None:
        self._function = function
        self._panel = panel
        self._edges = np.zeros(1)
        self._series = np.zeros((0, PANEL_POINTS + 1), dtype=complex)
        self._starts = np.zeros(1, dtype=complex)

    @cached_property
    def _real(self) -> bool:
        return not np.iscomplexobj(self._function(np.zeros(1)))

    def _extend(self, end: float) -> None:
        wanted = np.ceil((end - self._edges[-1]) / self._panel)
        if not wanted <= MOST_PANELS:
            raise OverflowError(f"an integral to {end:.3g} in panels of {self._panel:.3g} has too many of them")
        count = max(1, int(wanted))
        edges = np.linspace(self._edges[-1], self._edges[-1] + count * self._panel, count + 1)
        left, width = edges[:-1], np.full(count, self._panel)
        rights: list[Array] = []
        integrals: list[NDArray[Any]] = []
        scale = 0.0
        for halving in range(MOST_HALVINGS + 1):
            places = left[:, None] + 0.5 * width[:, None] * (1 + _GAUSS_POINTS)
            values = self._function(places.ravel()).reshape(places.shape)
            series = values @ _TO_COEFFICIENTS.T
            scale = max(scale, float(np.abs(values).max(initial=0.0)))
            # Rounding of the times causes noise of eps * time * slope, which halving does not reduce.
            noise = 4e-15 * scale * max(1.0, (places.max() / self._panel) * 0.02)
            done = np.abs(series[:, -TAIL:]).max(axis=1) <= noise
            done |= np.abs(series[:, -TAIL:]).max(axis=1) * width <= 1e-17 * scale * self._panel
            if halving == MOST_HALVINGS:
                done[:] = True
            integrals.append(0.5 * width[done, None] * (series[done] @ _INTEGRATE.T))
            rights.append(np.stack([left[done], left[done] + width[done]], axis=1))
            if done.all():
                break
            half = width[~done] / 2
            left, width = np.concatenate([left[~done], left[~done] + half]), np.concatenate([half, half])
        bounds, panels = np.concatenate(rights), np.concatenate(integrals)
        order = np.argsort(bounds[:, 0], kind="stable")
        panels = panels[order]
        self._edges = np.concatenate([self._edges, bounds[order, 1]])
        self._series = np.concatenate([self._series, panels.astype(complex)])
        self._starts = np.concatenate([self._starts, self._starts[-1] + np.cumsum(panels.sum(axis=1))])

    def __call__(self, t: ArrayLike) -> NDArray[Any]:
        times = np.asarray(t, dtype=float)
        flat = times.ravel()
        if flat.size and flat.max() > self._edges[-1]:
            self._extend(float(flat.max()))
        if self._series.shape[0] == 0:
            return np.zeros(times.shape)
        which = np.clip(np.searchsorted(self._edges, flat, side="right") - 1, 0, len(self._edges) - 2)
        width = self._edges[which + 1] - self._edges[which]
        place = 2 * (flat - self._edges[which]) / width - 1
        out = (self._starts[which] + _series_at(self._series[which], place)).reshape(times.shape)
        return np.real(out) if self._real else out


# The error is (radius / distance to the nearest singularity)^CIRCLE_POINTS.
CIRCLE_POINTS = 64


def derivative(position: Callable[[Any], Any], t: float, order: int = 1, radius: float = 0.25) -> Array:
    """The derivative (...) of an analytic function at time t [s] from values on a circle of `radius` [s]."""
    circle = radius * np.exp(2j * math.pi * np.arange(CIRCLE_POINTS) / CIRCLE_POINTS)
    integrand = [np.asarray(position(t + z)) / z**order for z in circle]
    return math.factorial(order) * np.mean(integrand, axis=0).real
