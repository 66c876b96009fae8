"""The integral of a known function of time to rounding, and the derivative of an analytic one.

Integrals: adaptive panels of Chebyshev series. Derivatives: Cauchy's integral over a circle in the complex plane.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

# Twenty-four points resolve a panel of about one radian to rounding; the tail of the series tells when they have not.
DEGREE = 24
TAIL = 4
# A jump of the integrand can't be resolved, only boxed in: 46 halvings make the box smaller than rounding.
MOST_HALVINGS = 46

_NODES = np.cos(np.pi * (np.arange(DEGREE) + 0.5) / DEGREE)
_TO_SERIES = (2.0 / DEGREE) * np.cos(np.outer(np.arange(DEGREE), np.pi * (np.arange(DEGREE) + 0.5) / DEGREE))
_TO_SERIES[0] /= 2
_INTEGRATE = np.polynomial.chebyshev.chebint(np.eye(DEGREE), lbnd=-1)  # (DEGREE + 1, DEGREE)


def _series_at(series: NDArray[Any], place: NDArray[np.float64]) -> NDArray[Any]:
    """Clenshaw's sum of one series (times, terms) per place (times,)."""
    later, latest = np.zeros_like(series[:, 0]), np.zeros_like(series[:, 0])
    for term in range(series.shape[1] - 1, 0, -1):
        later, latest = series[:, term] + 2 * place * later - latest, later
    return series[:, 0] + place * later - latest


MOST_PANELS = 100_000  # 40 MB of nodes; a scene of this suite has at most a few hundred


class Antiderivative:
    """int_0^t f, for a real or complex f that takes an array of times; grows as far as it is asked, never shrinks.

    `panel` [s] is the longest panel, on the order of the fastest time in f, so that nothing hides between the points.
    """

    def __init__(self, function: Callable[[NDArray[np.float64]], NDArray[Any]], panel: float) -> None:
        self._function = function
        self._panel = panel
        self._edges = np.zeros(1)
        self._series = np.zeros((0, DEGREE + 1), dtype=complex)
        self._starts = np.zeros(1, dtype=complex)

    @cached_property
    def _real(self) -> bool:
        return not np.iscomplexobj(self._function(np.zeros(1)))

    def _extend(self, end: float) -> None:
        """Add panels up to `end`, halving those whose series has not come to its end."""
        wanted = np.ceil((end - self._edges[-1]) / self._panel)
        if not wanted <= MOST_PANELS:
            raise OverflowError(f"an integral to {end:.3g} in panels of {self._panel:.3g} has too many of them")
        count = max(1, int(wanted))
        edges = np.linspace(self._edges[-1], self._edges[-1] + count * self._panel, count + 1)
        left, width = edges[:-1], np.full(count, self._panel)
        rights: list[NDArray[np.float64]] = []
        found: list[NDArray[Any]] = []
        scale = 0.0
        for halving in range(MOST_HALVINGS + 1):
            places = left[:, None] + 0.5 * width[:, None] * (1 + _NODES)
            values = self._function(places.ravel()).reshape(places.shape)
            series = values @ _TO_SERIES.T
            scale = max(scale, float(np.abs(values).max(initial=0.0)))
            # Rounding of the arguments makes noise of eps * time * slope: don't chase it when panels lie far from zero.
            noise = 4e-15 * scale * max(1.0, (places.max() / self._panel) * 0.02)
            done = np.abs(series[:, -TAIL:]).max(axis=1) <= noise
            done |= np.abs(series[:, -TAIL:]).max(axis=1) * width <= 1e-17 * scale * self._panel
            if halving == MOST_HALVINGS:
                done[:] = True
            found.append(0.5 * width[done, None] * (series[done] @ _INTEGRATE.T))
            rights.append(np.stack([left[done], left[done] + width[done]], axis=1))
            if done.all():
                break
            half = width[~done] / 2
            left, width = np.concatenate([left[~done], left[~done] + half]), np.concatenate([half, half])
        bounds, panels = np.concatenate(rights), np.concatenate(found)
        order = np.argsort(bounds[:, 0], kind="stable")
        panels = panels[order]
        self._edges = np.concatenate([self._edges, bounds[order, 1]])
        self._series = np.concatenate([self._series, panels.astype(complex)])
        self._starts = np.concatenate([self._starts, self._starts[-1] + np.cumsum(panels.sum(axis=1))])

    def __call__(self, t: ArrayLike) -> NDArray[Any]:
        """The integral from 0 to times t >= 0 (any shape)."""
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


CIRCLE_POINTS = 64  # errors fall like (radius / distance to the next singularity)^points


def derivative(position: Callable[[Any], Any], t: float, order: int = 1, radius: float = 0.25) -> NDArray[np.float64]:
    """The derivative (...) of an analytic position at time t [s], from its values on a circle of `radius` [s]."""
    circle = radius * np.exp(2j * math.pi * np.arange(CIRCLE_POINTS) / CIRCLE_POINTS)
    terms = [np.asarray(position(t + z)) / z**order for z in circle]
    return math.factorial(order) * np.mean(terms, axis=0).real
