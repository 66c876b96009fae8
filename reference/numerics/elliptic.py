"""Jacobi's elliptic functions from the complementary parameter, so that they stay exact next to the separatrix.

With m = k^2 the parameter and n = 1 - m the complementary one, everything here takes n: close to m = 1 the motion
depends on the logarithm of n, and n can't be had from a rounded m. Method: the arithmetic-geometric mean; R. Bulirsch,
"Numerical calculation of elliptic integrals and elliptic functions", Numerische Mathematik 7 (1965) 78-90.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ellipkm1, elliprf

Array = NDArray[np.float64]

# The mean converges quadratically: once two iterates agree to this fraction, the next agree to its square.
HALF_PRECISION = 1e-9


def quarter_period(complement: float) -> float:
    """K [1], the complete integral of the first kind, for 0 <= n <= 1; infinite at n = 0."""
    return float(ellipkm1(complement))


def incomplete(sine: ArrayLike, cosine: ArrayLike, complement: float) -> Array:
    """F [1], the incomplete integral of the first kind, of the amplitude atan2(sine, cosine) in (-pi, pi].

    Taken from a sine and a cosine (their common scale is free), because close to n = 0 an amplitude near pi/2 can't
    carry the digits that F needs. At n = 0 the cosine must be positive.
    """
    sine, cosine = np.asarray(sine, dtype=float), np.asarray(cosine, dtype=float)
    size = np.hypot(sine, cosine)
    sine, cosine = sine / size, cosine / size
    # cos^2 + n sin^2 is 1 - m sin^2 without its cancellation.
    within = sine * elliprf(cosine**2, cosine**2 + complement * sine**2, 1.0)
    if complement == 0:
        return within
    return np.where(cosine >= 0, within, np.copysign(2 * quarter_period(complement), sine) - within)


def jacobi(argument: ArrayLike, complement: float) -> tuple[Array, Array, Array, Array]:
    """(sn, cn, dn, am) at the arguments, for 0 <= n <= 1; am, the amplitude [rad], is continuous (not wrapped)."""
    argument = np.asarray(argument, dtype=float)
    if complement == 0:
        sine, cosine = np.tanh(argument), 1 / np.cosh(argument)
        return sine, cosine, cosine, np.arctan(np.sinh(argument))
    quarter = quarter_period(complement)
    half_turns = np.round(argument / (2 * quarter))
    rest = argument - 2 * quarter * half_turns
    sign = np.where(half_turns % 2 == 0, 1.0, -1.0)
    # Beyond K/2 the functions are taken from the other end: near K, cn and dn keep their relative accuracy only so.
    far = np.abs(rest) > quarter / 2
    sine, cosine, delta = _first_quarter(np.where(far, quarter - np.abs(rest), np.abs(rest)), complement)
    root = math.sqrt(complement)
    sine, cosine, delta = (
        np.where(far, cosine / delta, sine),
        np.where(far, root * sine / delta, cosine),
        np.where(far, root / delta, delta),
    )
    amplitude = np.copysign(np.arctan2(sine, cosine), rest) + math.pi * half_turns
    return sign * np.copysign(sine, rest), sign * cosine, delta, amplitude


def _first_quarter(argument: Array, complement: float) -> tuple[Array, Array, Array]:
    """(sn, cn, dn) for 0 <= argument <= K/2, by the descending mean."""
    means, roots = [], []
    mean, root = 1.0, math.sqrt(complement)
    while True:
        means.append(mean)
        roots.append(root)
        if abs(mean - root) <= HALF_PRECISION * mean:
            break
        mean, root = (mean + root) / 2, math.sqrt(mean * root)
    angle = argument * (means[-1] + roots[-1]) / 2
    sine, cosine = np.sin(angle), np.cos(angle)
    nonzero = sine != 0
    cotangent = cosine / np.where(nonzero, sine, 1.0)
    scaled = cotangent * (means[-1] + roots[-1]) / 2
    delta = np.ones_like(argument)
    for mean, root in zip(reversed(means), reversed(roots), strict=True):
        product = cotangent * scaled
        scaled = scaled * delta
        delta = (root + product) / (mean + product)
        cotangent = scaled / mean
    size = 1 / np.sqrt(scaled**2 + 1)
    return np.where(nonzero, size, 0.0), np.where(nonzero, scaled * size, 1.0), np.where(nonzero, delta, 1.0)
